"""Accuracy on published sets of divers' signs: SDG11, SCUBANetV2 and CADDY's gestures.

The folder holds one of these sets in its authors' layout, by which it is identified. In each draw
one random take per sign makes a language; all other takes of the signs are queries, up to a number.
A query is *alike* if the demonstration of its sign was shown in the same setting (SDG11: place and
view; SCUBANetV2: clip; CADDY: scenario), else *other*. A take without a sign that gets a label is a
false alarm. These sets do not name people.

    python -m benchmarks.accuracy.divers FOLDER [--draws 20] [--queries 200] [--keep FOLDER]
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from app.evaluation.labelled_takes import ClipRecorder
from app.evaluation.share import Share
from app.recognition import Gesture, GestureError, Language, PoseError, Recognition, Recognizer
from benchmarks.sets.divers.diver_take import DiverTake
from benchmarks.sets.divers.published_sets import find_set

PROFILES = ("full", "paper")


@dataclass(frozen=True)
class Outcome:
    """Outcome of one query.

    Attributes
    ----------
    kind
        Setting relative to the demonstration, ``"alike"`` or ``"other"``, or ``"no sign"``.
    right
        Whether the nearest gesture is the sign; False where none is shown.
    labelled
        Whether it was accepted as any gesture.

    """

    kind: str
    right: bool
    labelled: bool


def make_gestures(takes: Sequence[DiverTake]) -> dict[int, Gesture]:
    """Make a gesture of each take that can be a demonstration, by the take's number."""
    made = {}
    for number, take in enumerate(takes):
        if take.label is not None:
            try:
                made[number] = Gesture.from_demonstration(take.label, take.poses)
            except GestureError:
                continue
    return made


def draw_outcomes(
    takes: Sequence[DiverTake],
    gestures: dict[int, Gesture],
    *,
    profile: str,
    draws: int,
    queries: int,
    seed: int,
) -> Iterator[Outcome]:
    """Yield the outcome of every query of every language drawn; none with fewer than two signs."""
    by_label: dict[str, list[int]] = defaultdict(list)
    for number, gesture in gestures.items():
        by_label[gesture.label].append(number)
    if len(by_label) < 2:
        return
    generator = np.random.default_rng(seed)
    for _ in range(draws):
        templates = {label: int(generator.choice(of)) for label, of in sorted(by_label.items())}
        language = Language("drawn", [gestures[number] for number in templates.values()])
        recognizer = Recognizer(language, profile)
        left = [
            number
            for number, take in enumerate(takes)
            if number not in templates.values() and (take.label is None or take.label in templates)
        ]
        for number in generator.permutation(left)[:queries]:
            shown = takes[number]
            kind = "no sign"
            if shown.label is not None:
                like = takes[templates[shown.label]].setting == shown.setting
                kind = "alike" if like else "other"
            result = _recognize(recognizer, shown)
            yield Outcome(
                kind,
                right=result is not None and result.nearest == shown.label,
                labelled=result is not None and result.outcome != "rejected",
            )


def _recognize(recognizer: Recognizer, take: DiverTake) -> Recognition | None:
    try:
        return recognizer.recognize(take.poses)
    except PoseError:
        return None


def report(takes: Sequence[DiverTake], *, draws: int, queries: int, seed: int) -> Iterator[str]:
    """Yield the lines of the report on a set's takes."""
    gestures = make_gestures(takes)
    signs = {take.label for take in takes if take.label is not None}
    asked = sum(take.label is not None for take in takes)
    yield f"{len(signs)} signs, {asked} takes of them, {len(takes) - asked} without a sign"
    yield f"can be a demonstration: {Share(len(gestures), asked)}"
    for profile in PROFILES:
        found: dict[str, list[Outcome]] = defaultdict(list)
        for outcome in draw_outcomes(
            takes, gestures, profile=profile, draws=draws, queries=queries, seed=seed
        ):
            found[outcome.kind].append(outcome)
        for kind, outcomes in sorted(found.items()):
            labelled = sum(each.labelled for each in outcomes)
            if kind == "no sign":
                yield f"{profile:5} {kind:8} false alarms {Share(labelled, len(outcomes))}"
                continue
            right = [each for each in outcomes if each.right]
            refused = sum(not each.labelled for each in right)
            yield (
                f"{profile:5} {kind:8} nearest {Share(len(right), len(outcomes))}, "
                f"of these refused {Share(refused, len(right))}, n = {len(outcomes)}"
            )


def main() -> None:
    """Print the name of the set and the report on it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, help="the set, as its authors give it")
    parser.add_argument("--draws", type=int, default=20, help="languages")
    parser.add_argument(
        "--queries", type=int, default=200, help="queries of each language, at most"
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="cache folder of what is found in clips")
    given = parser.parse_args()
    published = find_set(given.folder)
    with closing(ClipRecorder(given.keep)) as recorder:
        takes = list(published.reads(given.folder, recorder))
    print(published.name)
    for line in report(takes, draws=given.draws, queries=given.queries, seed=given.seed):
        print(line, flush=True)


if __name__ == "__main__":
    main()
