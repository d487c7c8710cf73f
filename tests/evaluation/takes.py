"""Labelled takes for tests: swipes and circles drawn by simulated people."""

from collections.abc import Collection

from app.evaluation.one_shot import LabelledTake
from benchmarks.sets.drawn_sets import TAKES, drawn_sets


def drawn_takes(name: str, people: Collection[int], takes: int) -> list[LabelledTake]:
    """Return the first `takes` takes of each gesture by the people of those numbers."""
    (drawn,) = [each for each in drawn_sets() if each.name == name]
    return [
        LabelledTake(f"{name} {index}", str(label), str(person), poses)
        for index, (label, person, poses) in enumerate(
            zip(drawn.labels, drawn.people, drawn.recordings, strict=True)
        )
        if index % TAKES < takes and int(person.split()[1]) in people
    ]
