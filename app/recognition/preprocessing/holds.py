"""Holds: the hands whose shape is the gesture, and the shapes that they hold in sequence.

Both are for takes in which nothing else moves: `find_held_hands` finds the hands, and `find_holds`
divides the take into their shapes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from itertools import combinations_with_replacement, pairwise
from math import ceil
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.poses.frame import (
    SIDES,
    HandShape,
    Side,
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


MOST_HOLDS: Final = 2
"""Most shapes of one gesture: longer sequences are phrases, which name each of their signs."""

MOST_TOLD: Final = 3
"""Most shapes that are distinguished, one more than a gesture has. Each of two shapes is held in at
least a third of a hand's frames, each of three in a quarter: errors of the hand model are shorter,
with up to 1.1 sizes of the hand in a quarter of a sign's frames."""

TWO_SHAPES: Final = 0.65
"""Distance of two shapes that one hand holds one after the other, in sizes of the hand: the parts
of one sign are up to 0.58 apart where the hand wobbles or turns, most signs 0.7 and more."""

TWO_STILL_SHAPES: Final = 0.5
"""The same where both are held still: two fingers and a flat hand are 0.6 apart, one sign changes
by up to 0.43 at once. Nearer shapes are accepted for each other."""

STILL: Final = 0.2
"""Largest median distance of the frames from their own shape where it is held still, over that of
the two shapes: 0.05 to 0.13 for two drawn shapes, 0.24 and more for one rendered sign in two parts.
"""

AGREEING: Final = 0.85
"""Least share of the frames of a part that show its own shape: the change itself takes some."""

CLEARLY: Final = 2.0
"""Factor by which a hand that holds a shape is nearer to it than to the next one; in between, the
hand is changing."""

LEAST_HELD: Final = 0.3
"""Least seconds for which each of several shapes is held: a signer who shakes a letter, or draws
it, shows other shapes for up to 0.2 s."""

MOST_SHAKEN: Final = 20.0
"""Degrees by which one shape may turn in the image, as between two takes: a shaken hand turns."""

MOST_DRIFT: Final = 0.4
"""Largest distance between the first and the last third of a shape that lies between two others, in
sizes of the hand: a hand that slowly changes from one to the other drifts by 0.6, a hand that holds
a sign by 0.07 (median) to 0.44 (95 %)."""


@dataclass(frozen=True, eq=False)
class Hold:
    """A stretch of a take in which the hands keep their shapes.

    Attributes
    ----------
    hands
        One or two, left then right; of the same sides in all holds of a take.
    start, end
        Seconds, as in the take's poses, between which they are seen.

    """

    hands: tuple[HandShape, ...]
    start: float
    end: float


def find_holds(poses: PoseSequence, trajectory: Trajectory) -> tuple[Hold, ...]:
    """Find the hand shapes that a take holds one after the other, where nothing moves clearly.

    A hand changes its shape where the frames before and after differ by `TWO_SHAPES`, or by
    `TWO_STILL_SHAPES` where it holds both still. Between two holds the hand may be unseen; frames
    on the way count with the nearer shape.

    Parameters
    ----------
    poses
        Repaired poses of a take.
    trajectory
        The trajectory of `poses`, with as many moments or condensed.

    Returns
    -------
    None, one or several, in their order; none where a hand or the head moves clearly, or no hand
    holds a shape (`find_held_hands`).

    """
    if moves_clearly(trajectory):
        return ()
    several = [_find_holds_of(side, poses, trajectory) for side in SIDES]
    return max(several, key=len) or find_single_hold(poses, trajectory)


def find_single_hold(poses: PoseSequence, trajectory: Trajectory) -> tuple[Hold, ...]:
    """Find the hand shape of a take as if it held one only; parameters as for `find_holds`."""
    hands = find_held_hands(poses, trajectory)
    return (Hold(hands, float(poses.time[0]), float(poses.time[-1])),) if hands else ()


def keep_holds(trajectory: Trajectory, holds: Sequence[Hold]) -> Trajectory:
    """Return a trajectory with the hands of its holds; with none of more than `MOST_HOLDS`."""
    if len(holds) > MOST_HOLDS:
        return trajectory
    hands, then_hands = (*(hold.hands for hold in holds), (), ())[:MOST_HOLDS]
    return replace(trajectory, hands=hands, then_hands=then_hands)


def describe_excess(holds: Sequence[Hold]) -> str:
    """Return the message that a take shows three shapes although a gesture has two."""
    second, third = (hold.start for hold in holds[1:])
    return (
        f"three hand shapes one after the other, the second from {second:.1f} s and the third from "
        f"{third:.1f} s on, and a gesture has two at most"
    )


def _find_holds_of(side: Side, poses: PoseSequence, trajectory: Trajectory) -> tuple[Hold, ...]:
    """Return the holds of a hand that changes its shape; none if it does not."""
    found = []
    for start, end in _find_stretches(side, poses):
        hands = find_held_hands(poses.between(start, end), trajectory)
        if side not in [hand.side for hand in hands]:
            return ()
        found.append(Hold(hands, start, end))
    common = set(SIDES).intersection(*({hand.side for hand in each.hands} for each in found))
    return tuple(
        replace(each, hands=tuple(hand for hand in each.hands if hand.side in common))
        for each in found
    )


def _find_stretches(side: Side, poses: PoseSequence) -> list[tuple[float, float]]:
    """Return the seconds between which a hand is seen to hold each shape, if there are several."""
    if poses.hands is None:
        return []
    hands = poses.hands[:, SIDES.index(side)]
    seen = np.flatnonzero(np.isfinite(hands).all(axis=(1, 2)))
    if not len(seen) or len(seen) < LEAST_SEEN * len(poses):
        return []
    every = seen[choose_frames(len(seen))]
    shown = normalize_hands(hands[every])
    starts = _divide(shown)
    if len(starts) == 1:
        return []
    moments: FloatArray = poses.time[every]
    held = _leave_out_changes(shown, starts)
    found = [(float(moments[start]), float(moments[end])) for start, end in held]
    return found if all(end - start >= LEAST_HELD for start, end in found) else []


def _leave_out_changes(shown: FloatArray, starts: tuple[int, ...]) -> list[tuple[int, int]]:
    """Return the first and the last frame of every shape in a division of ``(T, 21, 2)``.

    At a change, a shape counts only while the hand is `CLEARLY` nearer to it than to the other one.
    No frames are returned if a shape never counts.
    """
    parts = [*zip(starts, (*starts[1:], len(shown)), strict=True)]
    shapes = [_take_median(shown[slice(*part)]) for part in parts]
    held = []
    for number, (start, end) in enumerate(parts):
        part, own = shown[start:end], shapes[number]
        others = (*shapes[max(0, number - 1) : number], *shapes[number + 1 : number + 2])
        nearest = np.min([measure_distances(part, other) for other in others], axis=0)
        clear = start + np.flatnonzero(CLEARLY * measure_distances(part, own) < nearest)
        if not len(clear):
            return []
        first = start if number == 0 else int(clear[0])
        last = end - 1 if number == len(parts) - 1 else int(clear[-1])
        held.append((first, last))
    return held


def _divide(shown: FloatArray) -> tuple[int, ...]:
    """Return the numbers of the frames ``(T, 21, 2)`` at which a shape begins, the first 0.

    The frames are divided into as many shapes as possible. Of all such divisions, the one with most
    frames that show their own shape is chosen, and of equal ones the one with the shapes farthest
    apart.
    """
    # Many divisions have parts in common.
    part = cache(partial(_Part, shown))
    for count in range(MOST_TOLD, 1, -1):
        found = [
            (*quality, starts)
            for starts in _list_divisions(len(shown), count)
            if (quality := _judge([*map(part, starts, (*starts[1:], len(shown)))])) is not None
        ]
        if found:
            return max(found)[-1]
    return (0,)


def _list_divisions(frames: int, count: int) -> Iterator[tuple[int, ...]]:
    """Yield the starts of all divisions into `count` parts of at least 1 / (count + 1) each."""
    least = max(1, ceil(frames / (count + 1)))
    for more in combinations_with_replacement(range(frames - count * least + 1), count - 1):
        yield (0, *(number * least + each for number, each in enumerate(more, start=1)))


@dataclass(frozen=True, eq=False)
class _Part:
    """The frames ``shown[start:end]`` of ``(T, 21, 2)``, measured when needed."""

    shown: FloatArray
    start: int
    end: int

    @cached_property
    def shape(self) -> FloatArray:
        """The median shape, ``(21, 2)``."""
        return _take_median(self.shown[self.start : self.end])

    @cached_property
    def distances(self) -> FloatArray:
        """The distances ``(T,)`` of all frames from the shape."""
        return measure_distances(self.shown, self.shape)

    @cached_property
    def spread(self) -> float:
        """The median distance of the part's own frames."""
        return float(np.median(self.distances[self.start : self.end]))

    @cached_property
    def drift(self) -> float:
        """The distance between the median shapes of the first and the last third."""
        frames = self.shown[self.start : self.end]
        third = max(1, len(frames) // 3)
        first, last = (_take_median(part) for part in (frames[:third], frames[-third:]))
        return float(measure_distances(first[None], last)[0])


def _judge(parts: Sequence[_Part]) -> tuple[int, float] | None:
    """Return how many frames show their own shape, and the least distance of adjacent shapes.

    None where adjacent shapes are alike, too few frames agree with their shape, or a shape between
    two others is a slow change.
    """
    agreeing, nearest = 0, np.inf
    for one, other in pairwise(parts):
        apart = _measure_unturned(one.shape, other.shape)
        if apart < TWO_STILL_SHAPES:
            return None
        if apart < TWO_SHAPES and max(one.spread, other.spread) > STILL * apart:
            return None
        nearest = min(nearest, apart)
        for own, foreign in ((one, other), (other, one)):
            frames = slice(own.start, own.end)
            own_side = own.distances[frames] < foreign.distances[frames]
            if own_side.mean() < AGREEING:
                return None
            agreeing += int(own_side.sum())
    # The slowest test comes last.
    if any(part.drift > MOST_DRIFT for part in parts[1:-1]):
        return None
    return agreeing, nearest


def _measure_unturned(one: FloatArray, other: FloatArray) -> float:
    """Return how far two shapes ``(21, 2)`` are apart, in sizes of the hand.

    A turn in the image by up to `MOST_SHAKEN` does not count: a signer shakes a letter.
    """
    product = np.vdot(one @ (1, 1j), other @ (1, 1j))
    beyond = max(abs(np.angle(product)) - np.radians(MOST_SHAKEN), 0.0)
    return float(np.sqrt(max(2 - 2 * abs(product) * np.cos(beyond) / len(one), 0.0)))


def _take_median(shown: FloatArray) -> FloatArray:
    """Return the median shape ``(21, 2)`` of ``(T, 21, 2)``."""
    median: FloatArray = normalize_hands(np.median(shown, axis=0)[None])[0]
    return median
