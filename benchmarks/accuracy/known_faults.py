"""Known faults: tests whether explanations name the one fault of a simulated take.

Plausible takes by another person are drawn of every gesture of the larger sample language, and
each is spoilt in one way. First: the first difference told is of that kind; named: any one is.

    python -m benchmarks.accuracy.known_faults [--takes 10] [--seed 0]
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.evaluation.proportion import Share
from app.recognition import Gesture, Language, Recognizer
from app.recognition.explanation.differences import find_differences
from app.recognition.explanation.pairing import Pairing
from app.recognition.features.motion import parse_body_part
from app.recognition.features.traversals import AS_SHOWN
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.landmarks import other_side
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import ARM_PARTS, draw_variants
from app.resources import samples_dir

Fault = Callable[[Trajectory], Trajectory]

CUT = 0.35
"""Share of a take's duration that is missing."""

APPROACH_SECONDS = 0.6
"""Seconds in which the hand comes from beside the hip."""


def turn_round(take: Trajectory) -> Trajectory:
    """Show it the other way round."""
    return replace(take, xy=take.xy[::-1].copy())


def last_missing(take: Trajectory) -> Trajectory:
    """Stop early."""
    return take.between(0.0, float(take.time[-1]) * (1 - CUT))


def first_missing(take: Trajectory) -> Trajectory:
    """Begin late."""
    late = take.between(float(take.time[-1]) * CUT, float(take.time[-1]))
    return replace(late, time=late.time - late.time[0])


def approach(take: Trajectory) -> Trajectory:
    """Come from beside the hip first."""
    step = float(np.median(np.diff(take.time)))
    share = np.arange(0, APPROACH_SECONDS, step)[:, None, None] / APPROACH_SECONDS
    hip = take.xy[:1] + 0.0
    moving = _of_arms(take)
    hip[:, moving] = (0.6, 0.9)
    come = hip * (1 - share) + take.xy[:1] * share
    time = np.concatenate([share.ravel() * APPROACH_SECONDS, take.time + APPROACH_SECONDS])
    return replace(take, xy=np.concatenate([come, take.xy]), time=time)


def exchange(take: Trajectory) -> Trajectory:
    """Exchange left and right in two stretches, a fifth of the moments in all."""
    names = take.landmarks
    others = [names.index(other_side(name)) for name in names]
    xy = take.xy.copy()
    for start, end in ((0.3, 0.4), (0.6, 0.7)):
        span = slice(int(start * len(xy)), int(end * len(xy)))
        xy[span] = xy[span][:, others]
    return replace(take, xy=xy)


def slower(take: Trajectory) -> Trajectory:
    """Take three times as long."""
    return replace(take, time=take.time * 3)


def higher(take: Trajectory) -> Trajectory:
    """Show it a torso length higher."""
    xy = take.xy.copy()
    xy[:, _of_arms(take)] -= (0.0, 1.0)
    return replace(take, xy=xy)


def larger(take: Trajectory) -> Trajectory:
    """Show it three times as large."""
    moving = _of_arms(take)
    xy = take.xy.copy()
    middle = xy[:, moving].mean(axis=0)
    xy[:, moving] = middle + 3 * (xy[:, moving] - middle)
    return replace(take, xy=xy)


FAULTS: dict[str, tuple[Fault, list[str]]] = {
    "none": (lambda take: take, []),
    "the other way round": (turn_round, ["direction"]),
    "the other hand": (Trajectory.mirror, ["hand"]),
    "last third missing": (last_missing, ["missing"]),
    "first third missing": (first_missing, ["missing"]),
    "too much before": (approach, ["extra"]),
    "sides exchanged": (exchange, ["exchanged_sides"]),
    "three times slower": (slower, ["tempo"]),
    "higher": (higher, ["place"]),
    "three times larger": (larger, ["size"]),
}


def main() -> None:
    """Print the differences reported per fault."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--takes", type=int, default=10, help="per gesture")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    language = Language.load(samples_dir() / "osg-table-2.json")
    recognizer = Recognizer(language, "full")
    for fault, (spoil, kinds) in FAULTS.items():
        first, named, told = Share(0, 0), Share(0, 0), Counter[str]()
        for gesture in language.gestures:
            for take in draw_takes(gesture, arguments.takes, arguments.seed):
                found = list_difference_kinds(recognizer, gesture, condense(spoil(take)))
                told[found[0] if found else "none"] += 1
                first += Share(int(found[:1] == kinds), 1)
                named += Share(int({*kinds} <= {*found} if kinds else not found), 1)
        print(f"{fault:20} first {first!s:20} named {named!s:20} {dict(told.most_common())}")


def draw_takes(gesture: Gesture, count: int, seed: int) -> tuple[Trajectory, ...]:
    """Draw takes of a gesture by another person."""
    assert gesture.trajectory is not None
    return draw_variants(gesture.trajectory, count, seed=seed, person="another")


def list_difference_kinds(recognizer: Recognizer, gesture: Gesture, query: Trajectory) -> list[str]:
    """Return the kinds of difference reported for a query, most important first."""
    compared = recognizer.compare(query)
    at = recognizer.language.labels.index(gesture.label)
    reading = compared.traversals[at] or AS_SHOWN
    pairing = Pairing.of(query, gesture, reading, mirrored=bool(compared.mirrored[at]))
    if pairing is None:
        return []
    return [each.kind for each in find_differences(pairing, sees_direction=True)]


def _of_arms(take: Trajectory) -> npt.NDArray[np.bool_]:
    """Return a mask ``(K,)`` of the landmarks of the arms."""
    return np.array(
        [parse_body_part(name).split("_", 1)[-1] in ARM_PARTS for name in take.landmarks]
    )


if __name__ == "__main__":
    main()
