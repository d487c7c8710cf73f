"""Held hands: finds the hands whose shape is the gesture, in takes in which nothing else moves."""

from __future__ import annotations

from collections.abc import Iterable
from math import ceil

import numpy as np
import numpy.typing as npt

from app.recognition.poses.frame import SIDES
from app.recognition.poses.hand_shape import (
    HandShape,
    choose_frames,
    measure_palms,
    normalize_hands,
)
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.salience import (
    LEAST_DISPLACEMENT,
    MIN_DISPLACEMENT,
    choose_representatives,
    measure_displacements,
)

HOLD_PERCENTILES = (20.0, 80.0)
"""The percentiles of a held hand's path taken as peak to peak: the hand may come and go in a fifth
of the time at either end, in which no stroke of a gesture is complete."""

REST = 0.5
"""Least share of a hand's frames in which it rests while it shows its shape: a signer lifts the
hand for each letter and lowers it again, which takes up to half of the time."""

MOST_APART = 0.8
"""Palms from the place where a hand rests at which it is still there: a wobbling flat hand
("something is wrong") moves by up to 0.6 to either side."""

MOST_WAY = 4.0
"""Palms by which it may come or go between `HOLD_PERCENTILES`: a lifted hand moves by up to 3.1, a
hand that pauses in a drawn figure by more than 4."""

LEAST_SEEN = 0.4
"""Least share of the frames in which a held hand is seen: the hand model loses a still hand under
water for up to half a second."""

MOST_CHANGE = 0.5
"""Largest median distance of a frame's shape from the median shape, in sizes of the hand: a hand
that opens and closes has no shape. A wobbling flat hand ("something is wrong") changes by up to
0.48; most pairs of signs are 0.7 and more apart."""

SMALLER = 0.6
"""Share of the smallest movement of a language below which a take is no movement of the language:
people's takes differ in size by a third of a doubling, and rarely by two."""

LEAST_SWAY = 0.1
"""Least movement, in torso lengths, of a hand that holds a shape: nobody hovers more steadily."""

LOWEST = 0.35
"""Lowest place of a hand that shows something, torso lengths below the torso's centre: a hand that
hangs is below the hips, at 0.5."""

_WRIST = HAND_LANDMARKS.index("wrist")


def find_least_movement(movements: Iterable[Trajectory]) -> float:
    """Return the least distance that a hand or the head moves in takes of a language's movements.

    Parameters
    ----------
    movements
        The demonstrations of the movements.

    Returns
    -------
    Torso lengths: `SMALLER` times the movement of the smallest, at least `LEAST_SWAY`; infinite
    without movements.

    """
    own = [measure_movement(each) for each in movements if each.unit == "torso_length"]
    return max(LEAST_SWAY, SMALLER * min(own, default=np.inf))


def find_held_hands(poses: PoseSequence, trajectory: Trajectory) -> tuple[HandShape, ...]:
    """Find the hands that hold a shape, where nothing moves clearly.

    A hand counts if it is seen in `LEAST_SEEN` of the frames, stays at one place, keeps its shape
    and does not hang down.

    Parameters
    ----------
    poses
        Repaired poses of a take, or of a part of it.
    trajectory
        The trajectory of the take, with as many moments or condensed.

    Returns
    -------
    At most two, left then right; none where a hand or the head moves clearly.

    """
    if poses.hands is None or not len(poses) or moves_clearly(trajectory):
        return ()
    held = []
    for index, side in enumerate(SIDES):
        hands = poses.hands[:, index]
        seen: npt.NDArray[np.bool_] = np.asarray(np.isfinite(hands).all(axis=(1, 2)))
        if seen.mean() < LEAST_SEEN or _hangs(poses, hands, seen):
            continue
        shown = hands[seen][choose_frames(int(seen.sum()))]
        resting = _find_rest(shown)
        if resting.mean() < REST or _measure_travel(shown) >= MOST_WAY:
            continue
        shown = shown[resting]
        shape = HandShape.of_frames(side, shown)
        if np.median(measure_distances(normalize_hands(shown), shape.xy)) <= MOST_CHANGE:
            held.append(shape)
    return tuple(held)


def measure_distances(hands: FloatArray, shape: FloatArray) -> FloatArray:
    """Return how far hands ``(T, 21, 2)`` are from a shape, ``(T,)`` in sizes of the hand."""
    return np.asarray(np.sqrt(((hands - shape) ** 2).sum(axis=2).mean(axis=1)))


def _find_rest(hands: FloatArray) -> npt.NDArray[np.bool_]:
    """Return the frames of ``(T, 21, 2)`` in which the hand is where it rests, ``(T,)``.

    That is the place of the `REST` of its frames, in a row, in which the wrist moves least, up to
    `MOST_APART`: a wobble belongs to it, the way there and back does not.
    """
    wrist = hands[:, _WRIST]
    windows = np.lib.stride_tricks.sliding_window_view(wrist, ceil(REST * len(hands)), axis=0)
    rest = windows[np.linalg.norm(np.ptp(windows, axis=2), axis=1).argmin()]
    away = np.linalg.norm(wrist - np.median(rest, axis=1), axis=1)
    return np.asarray(away <= MOST_APART * np.median(measure_palms(hands)))


def rests_between_ends(trajectory: Trajectory) -> bool:
    """Return whether hands and head rest between the ends of a take.

    At the ends a hand may be moved to its place and away again. A movement that is small as a whole
    counts as rest only if it is as still as a held hand.
    """
    moved = measure_displacements(trajectory)
    farthest = max((moved[name] for name in choose_representatives(trajectory)), default=0.0)
    return measure_movement(trajectory) < (
        LEAST_DISPLACEMENT if farthest >= MIN_DISPLACEMENT else LEAST_SWAY
    )


def moves_clearly(trajectory: Trajectory) -> bool:
    """Return whether a hand or the head moves as in a gesture; unknown without a torso."""
    return trajectory.unit == "torso_length" and measure_movement(trajectory) >= MIN_DISPLACEMENT


def measure_movement(trajectory: Trajectory) -> float:
    """Return how far a hand or the head moves between the ends of the take, in its unit."""
    paths = (
        trajectory.xy[:, trajectory.landmarks.index(name)]
        for name in choose_representatives(trajectory)
    )
    return max(
        (_measure_extent(path[np.isfinite(path).all(axis=1)]) for path in paths), default=0.0
    )


def _measure_extent(path: FloatArray) -> float:
    """Return the diagonal of the box around ``(T, 2)`` between `HOLD_PERCENTILES`."""
    if not len(path):
        return 0.0
    low, high = np.percentile(path, HOLD_PERCENTILES, axis=0)
    return float(np.hypot(*(high - low)))


def _measure_travel(hands: FloatArray) -> float:
    """Return how far a hand ``(T, 21, 2)`` moves, in palms."""
    palm = float(np.median(measure_palms(hands)))
    return _measure_extent(hands[:, _WRIST]) / max(palm, 1e-9)


def _hangs(poses: PoseSequence, hands: FloatArray, seen: npt.NDArray[np.bool_]) -> bool:
    """Return whether a hand is below the torso; False without a torso."""
    centre, length = poses.torso_centre(), poses.torso_length()
    if centre is None or length is None or not seen.any():
        return False
    below = (hands[seen, _WRIST, 1] - centre[seen, 1]) / length
    return bool(np.median(below) > LOWEST)
