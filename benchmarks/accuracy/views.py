"""Accuracy on people who are turned from the camera, one frontal demonstration a gesture.

Whole bodies recorded by depth cameras are turned about the vertical and projected. Three cases are
compared: no depth; demonstrations and takes with a depth as inaccurate as a pose model's; and takes
without depth against demonstrations with it. Takes are by other people.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path

from app.recognition import Language, PoseError, PoseSequence, Recognizer
from benchmarks.figures import Figure, Measurement, Results, share, table
from benchmarks.methods.ours import gesture_of
from benchmarks.sets.every_set import PEOPLE, find_file
from benchmarks.sets.one_shot_draws import draws
from benchmarks.sets.recorded_sets import RecordedSet
from benchmarks.sets.whole_body_sets import ARM_CLASSES, FILES, whole_body_sets

TURNS = (0, 30, 45, 60, -45)
"""Degrees, positive to the own left."""

DEPTH_ERROR = 0.05
"""Error of depth in metres: about that of pose models on limbs seen from the front."""

CASES = ("none", "known", "demonstrated")
"""What knows its depth: nothing, takes and demonstrations, or the demonstrations alone."""


def measure_turned(folder: Path, name: str, quick: bool) -> Iterator[Figure]:
    """Yield the shares of right nearest gestures by depth and turn."""
    sets = {turn: _load(folder, name, turn) for turn in TURNS}
    front = sets[0]
    right, asked = Counter[tuple[str, int]](), Counter[tuple[str, int]]()
    for chosen in draws(front, 2 if quick else 12, 25, seed=1):
        labels = [str(front.labels[index]) for index in chosen.templates]
        shown = [front.recordings[index] for index in chosen.templates]
        flat = [replace(each, world=None) for each in shown]
        with_depth, without = (
            Recognizer(Language(name, list(map(gesture_of, labels, each))), "full")
            for each in (shown, flat)
        )
        for case, turn, query in product(CASES, TURNS, chosen.others):
            poses = sets[turn].recordings[query]
            nearest = _find_nearest(
                without if case == "none" else with_depth,
                poses if case == "known" else replace(poses, world=None),
            )
            asked[case, turn] += 1
            right[case, turn] += nearest == str(front.labels[query])
    for (case, turn), n in asked.items():
        yield share(f"{case}/{turn}", right[case, turn], n)


def _load(folder: Path, name: str, turn: float) -> RecordedSet:
    (recorded,) = whole_body_sets(folder, [name], turn, depth=DEPTH_ERROR)
    return recorded


def _find_nearest(recognizer: Recognizer, poses: PoseSequence) -> str | None:
    try:
        return recognizer.recognize(poses).nearest
    except PoseError:
        return None


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield one for each set of whole bodies."""
    trajectories = folder / "trajectories"
    for name in (each for each in ARM_CLASSES if each not in FILES):
        yield Measurement(
            f"turned/{name}",
            partial(measure_turned, trajectories, name),
            data=f"{name}, turned about the vertical and projected",
            protocol="12 languages by one frontal person, 25 takes each by others",
            people=PEOPLE[name],
            reads=find_file(trajectories, name),
        )


def write_turned(results: Results) -> str:
    """Write a row for each set, a column for each turn: without depth / with it."""
    rows = [
        [
            name,
            *(
                " / ".join(
                    results.show(f"turned/{name}", f"{case}/{turn}", "bare")
                    for case in ("none", "known")
                )
                for turn in TURNS
            ),
        ]
        for name in results.names("turned")
    ]
    return table(("set", *(f"{turn} degrees" for turn in TURNS)), rows)


TABLES = {"turned": write_turned}
