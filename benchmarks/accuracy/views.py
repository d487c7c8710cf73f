"""Accuracy on people who are turned from the camera, one frontal demonstration a gesture.

Whole bodies recorded by depth cameras are turned about the vertical and projected. Three cases are
compared: no depth; demonstrations and queries with a depth as inaccurate as a pose model's; and
queries without depth against demonstrations with it. UD: queries by the person who demonstrated,
UI: by others. The interval is Wilson's.

    python -m benchmarks.accuracy.views ../shared/data --draws 20 --queries 30
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import product
from pathlib import Path

from app.evaluation.share import Share
from app.recognition import Language, PoseError, PoseSequence, Recognizer
from benchmarks.arguments import set_arguments
from benchmarks.methods.ours import gesture_of
from benchmarks.sets.one_shot_draws import draws
from benchmarks.sets.recorded_sets import RecordedSet
from benchmarks.sets.whole_body_sets import ARM_CLASSES, whole_body_sets

TURNS = (0, 30, 45, 60, -45)
"""Degrees, positive to the own left."""

DEPTH_ERROR = 0.05
"""Error of depth in metres: about that of pose models on limbs seen from the front."""

METHODS = ("no depth", "depth", "query without depth")

Key = tuple[str, str, str, int]
"""Key of a result: set, relation, method, turn."""


def without_depth(poses: PoseSequence) -> PoseSequence:
    """Return poses without their depth."""
    return replace(poses, world=None)


def measure(folder: Path, name: str, draw: int, queries: int, seed: int) -> dict[Key, Share]:
    """Return the shares of right nearest gestures of one draw."""
    sets = {turn: _load(folder, name, turn) for turn in TURNS}
    front = sets[0]
    *_, chosen = draws(front, draw + 1, queries, seed)
    labels = [str(front.labels[index]) for index in chosen.templates]
    shown = [front.recordings[index] for index in chosen.templates]
    with_depth = Recognizer(Language(name, list(map(gesture_of, labels, shown))), "full")
    flat = Recognizer(
        Language(name, list(map(gesture_of, labels, map(without_depth, shown)))), "full"
    )
    right: dict[Key, Share] = {}
    relations = {"UD": chosen.own, "UI": chosen.others}
    for (relation, of_relation), method, turn in product(relations.items(), METHODS, TURNS):
        recognizer = flat if method == "no depth" else with_depth
        total = Share(0, 0)
        for query in of_relation:
            poses = sets[turn].recordings[query]
            poses = poses if method == "depth" else without_depth(poses)
            total += Share(_nearest(recognizer, poses) == str(front.labels[query]), 1)
        right[name, relation, method, turn] = total
    return right


def _load(folder: Path, name: str, turn: float) -> RecordedSet:
    (recorded,) = whole_body_sets(folder, [name], turn, depth=DEPTH_ERROR)
    return recorded


def _nearest(recognizer: Recognizer, poses: PoseSequence) -> str | None:
    try:
        return recognizer.recognize(poses).nearest
    except PoseError:
        return None


def print_table(right: dict[Key, Share], names: Sequence[str]) -> None:
    """Print one line a set, relation and method."""
    print(f"{'':36}" + "".join(f"{turn:>22}" for turn in TURNS))
    for name, relation, method in product(names, ("UD", "UI"), METHODS):
        cells = "".join(f"{right[name, relation, method, turn]!s:>22}" for turn in TURNS)
        print(f"{name:10} {relation} {method:22}{cells}", flush=True)


def main() -> None:
    """Print the table of all sets."""
    given = set_arguments(__doc__, draws=20, queries=30).parse_args()
    names = [name for name in ARM_CLASSES if given.sets is None or name in given.sets]
    total: dict[Key, Share] = {}
    work = list(product([given.data / "trajectories"], names, range(given.draws)))
    with ProcessPoolExecutor(2) as pool:
        for found in pool.map(
            measure,
            *zip(*work, strict=True),
            [given.queries] * len(work),
            [given.seed] * len(work),
        ):
            for key, share in found.items():
                total[key] = total.get(key, Share(0, 0)) + share
    print_table(total, names)


if __name__ == "__main__":
    main()
