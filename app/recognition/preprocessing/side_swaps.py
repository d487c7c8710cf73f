"""Exchanged sides: frames in which the pose model took the left for the right.

Without a face in view the model mistakes the sides for a frame or for many; both hands then jump to
each other's place and back. Hands that really meet, cross or part keep their velocity, so the sides
are exchanged where that makes the movement steadier: the least sum of accelerations, by the best
path through the frames (Viterbi 1967).

Places are looked at in single precision, a millionth of a torso length: it takes half as long.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from app.recognition.features.median import median
from app.recognition.features.motion import parse_body_part
from app.recognition.poses.landmarks import SHOULDERS, other_side
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.outliers import measure_body_unit

TOLL = 0.5
"""What a change of sides must save at least, as a share of the distance between the sides.

A mistaken frame costs several such distances. On other people's undamaged two-handed recordings,
hands that cross and meet among them, one in 500 is changed at all; from 1 on, a tenth of the
exchanged frames are no longer found.
"""

TREMBLES = 3.0
"""How many times the usual acceleration a change of sides must save at least: where landmarks
tremble, two hands beside each other seem steadier exchanged now and then."""

MOST_EXCHANGED = 0.5
"""Share of the frames beyond which it is the others that are mistaken."""

UNSEEN_SPEED = 5.0
"""Torso lengths a second that hands without a body may have moved while not seen: a quick stroke.
From 3 down, one in twenty recordings of two hands with gaps is changed."""

FRONTAL = 0.25
"""Torso lengths between the shoulders, from which their width tells the sides apart; of a diver
seen from the side it means nothing."""

BLENDED = 0.9
"""Share of the median width of the shoulders below which a frame of a mistaken recording is between
the two: a pose model's own smoothing blends the sides there, and hands lie before the trunk. From
0.88 to 0.94 one frame or two decide; below, the last of them draws a stroke that was never made."""

ELBOWS = ("left_elbow", "right_elbow")

ARMS_BLENDED = 0.95
"""Share of the elbows' distance before and after below which a frame of a mistaken recording shows
blended arms. From 0.9 to 0.97 the sample clip that needs it is read right on every processor."""

BLEND_SECONDS = 0.25
"""Longest time from a blended frame to one that shows the arms apart: a pose model's smoothing
has settled by then (from 0.2 to 0.4 s the result is the same)."""

Mask = npt.NDArray[np.bool_]
SingleArray = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class SideSwaps:
    """Which frames of a recording of T are mistaken.

    Attributes
    ----------
    exchanged
        ``(T,)``: left and right were taken for each other.
    blended
        ``(T,)``: between a mistaken frame and a right one, the sides lie mixed.

    """

    exchanged: Mask
    blended: Mask


@lru_cache(maxsize=64)
def pair_sides(landmarks: tuple[str, ...]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the places of the landmarks of the left side, and of their counterparts."""
    parts = [parse_body_part(name) for name in landmarks]
    left = tuple(
        index
        for index, part in enumerate(parts)
        if "left" in part.split("_") and other_side(part) in parts
    )
    return left, tuple(parts.index(other_side(parts[index])) for index in left)


@lru_cache(maxsize=64)
def _coordinates_of_sides(landmarks: tuple[str, ...]) -> npt.NDArray[np.intp]:
    """Return where among all coordinates those of both sides lie: ``(2, 2, K)``.

    First all x, then all y, and of each the left side's before the right one's, so that what is
    added up lies side by side in memory.
    """
    sides = 2 * np.array(pair_sides(landmarks), dtype=np.intp)
    return np.stack([sides, sides + 1])


def find_side_swaps(trajectory: Trajectory) -> SideSwaps:
    """Find the frames in which left and right were mistaken for each other.

    All landmarks of a side are exchanged together: the model mistakes the whole body. Frames that
    show nothing count as right, and so does all of a recording with one side or fewer than three
    frames.
    """
    frames = len(trajectory)
    none = SideSwaps(np.zeros(frames, dtype=bool), np.zeros(frames, dtype=bool))
    sides = _coordinates_of_sides(trajectory.landmarks)
    if not sides.size:
        return none
    xy = trajectory.xy.reshape(frames, -1).take(sides, axis=1).astype(np.float32)
    blended = _blended(trajectory)
    known = np.isfinite(xy)
    clear = (~blended if known.all() else known.any(axis=(1, 2, 3)) & ~blended).nonzero()[0]
    if len(clear) < 3:
        return none
    xy = xy if len(clear) == frames else xy[clear]
    if (unit := measure_body_unit(trajectory)) != 1.0:
        xy = xy / unit
    between = _lengths(xy[:, :, 0] - xy[:, :, 1])
    toll = TOLL * median(np.add.reduce(between, axis=1, dtype=np.float64))
    # A body in view tells its sides apart by the trunk, wherever the hands went meanwhile.
    speed = 0.0 if set(SHOULDERS) <= set(trajectory.landmarks) else UNSEEN_SPEED
    accelerations = _Accelerations.between(xy, trajectory.time[clear], speed)
    kept = accelerations.of(0, 0, 0)
    toll = max(toll, TREMBLES * median(kept))
    # A change of sides spares at most the two accelerations around it.
    if (kept[1:] + kept[:-1]).max(initial=kept[0]) <= toll:
        return none
    mistaken = _steadiest(accelerations.of_all(), toll)
    if not mistaken.any():
        return none
    if mistaken.mean() > MOST_EXCHANGED:
        mistaken = ~mistaken
    exchanged = none.exchanged.copy()
    exchanged[clear] = mistaken
    return SideSwaps(exchanged, blended | _blended_arms(trajectory, blended))


def swap_sides(values: FloatArray, landmarks: tuple[str, ...], frames: Mask) -> FloatArray:
    """Give the landmarks of either side the values of the other one.

    Parameters
    ----------
    values
        ``(T, K, ...)``, of each landmark at each moment.
    landmarks
        K names.
    frames
        ``(T,)`` the moments at which to do so, see `Sides.exchanged`.

    """
    left, right = pair_sides(landmarks)
    order = np.arange(len(landmarks))
    order[[*left, *right]] = [*right, *left]
    changed = values.copy()
    changed[frames] = values[frames][:, order]
    return changed


def _blended(trajectory: Trajectory) -> Mask:
    """Tell ``(T,)`` in which frames the shoulders are too close to each other."""
    if not set(SHOULDERS) <= set(trajectory.landmarks):
        return np.zeros(len(trajectory), dtype=bool)
    first, second = (trajectory.landmarks.index(name) for name in SHOULDERS)
    across = trajectory.xy[:, first] - trajectory.xy[:, second]
    width = np.sqrt(np.vecdot(across, across))
    known = width[np.isfinite(width)]
    usual = median(known) if len(known) else 0.0
    return np.asarray(width < (BLENDED * usual if usual > FRONTAL else 0.0))


def _blended_arms(trajectory: Trajectory, blended: Mask) -> Mask:
    """Find ``(T,)`` frames whose elbows lie nearer to each other than shortly before and after.

    The model's smoothing blends arms for longer than shoulders, which are closer to each other.
    Exchanged sides do not change the distance.

    Parameters
    ----------
    trajectory
        T frames, some of which show exchanged sides.
    blended
        ``(T,)``: frames that are known to be blended, and are no measure for others.

    """
    near = np.zeros(len(trajectory), dtype=bool)
    if not set(ELBOWS) <= set(trajectory.landmarks):
        return near
    first, second = (trajectory.landmarks.index(name) for name in ELBOWS)
    apart = np.linalg.norm(trajectory.xy[:, first] - trajectory.xy[:, second], axis=1)
    usable = np.isfinite(apart) & ~blended
    for index in np.flatnonzero(usable):
        since = trajectory.time - trajectory.time[index]
        before = apart[usable & (since < 0) & (since >= -BLEND_SECONDS)]
        after = apart[usable & (since > 0) & (since <= BLEND_SECONDS)]
        usual = min(before.max(initial=0.0), after.max(initial=0.0))
        near[index] = apart[index] < ARMS_BLENDED * usual
    return near


@dataclass(frozen=True, eq=False)
class _Accelerations:
    """By how much landmarks miss where their velocity would have carried them.

    Attributes
    ----------
    both
        ``(T, 2, 2, K)`` each: x and y of the landmarks of both sides, kept (0) or exchanged (1),
        in torso lengths.
    carried
        ``(T - 2, 1, 1, 1)``: share of the last step by which the next one carries on.
    elsewhere
        ``(T - 2, 1, 1)``: torso lengths that a landmark may have gone elsewhere in a gap; 0 where
        none may.

    """

    both: tuple[SingleArray, SingleArray]
    carried: SingleArray
    elsewhere: SingleArray | float

    @classmethod
    def between(cls, xy: SingleArray, time: FloatArray, unseen_speed: float) -> _Accelerations:
        """Prepare for ``(T, 2, 2, K)`` at ``(T,)`` and a speed in gaps, torso lengths a second."""
        steps = time[1:] - time[:-1]
        # After a gap a hand may have stopped, so it is carried no farther than between the frames
        # before, and it may have gone elsewhere.
        share = np.minimum(steps[1:] / steps[:-1], 1.0)
        carried = share.astype(np.float32)[:, None, None, None]
        both = (xy, xy[:, :, ::-1])
        if unseen_speed == 0.0:
            return cls(both, carried, 0.0)
        gaps = np.maximum(steps[1:], steps[:-1]) - median(steps)
        elsewhere = unseen_speed * np.maximum(gaps, 0.0)
        return cls(both, carried, elsewhere.astype(np.float32)[:, None, None])

    def of(self, first: int, second: int, third: int) -> FloatArray:
        """Sum them, ``(T - 2,)``, for frames of which each is kept (0) or exchanged (1).

        A landmark that is not seen in all three counts nothing.
        """
        before, last = self.both[first][:-2], self.both[second][1:-1]
        carried_on = last - before
        carried_on *= self.carried
        off = self.both[third][2:] - last
        off -= carried_on
        missed = _lengths(off, self.elsewhere)
        return np.asarray(np.add.reduce(missed, axis=(1, 2), dtype=np.float64))

    def of_all(self) -> FloatArray:
        """Sum them for every choice: ``(T - 2, 2, 2, 2)``."""
        choices = [self.of(*choice) for choice in np.ndindex(2, 2, 2)]
        return np.stack(choices, axis=1).reshape(-1, 2, 2, 2)


def _lengths(vectors: SingleArray, less: SingleArray | float = 0.0) -> SingleArray:
    """Return how much longer than `less` vectors ``(T, 2, ...)`` are; 0 where not, or not known.

    The vectors are overwritten.
    """
    squares = np.multiply(vectors, vectors, out=vectors)
    lengths = squares[:, 0] + squares[:, 1]
    np.sqrt(lengths, out=lengths)
    if isinstance(less, np.ndarray):
        lengths -= less
    return np.asarray(np.fmax(lengths, 0.0, out=lengths))


def _steadiest(missed: FloatArray, toll: float) -> Mask:
    """Choose ``(T,)`` frames to exchange so that the sum is least; the first one is kept.

    Parameters
    ----------
    missed
        See `_Accelerations.of_all`.
    toll
        Added for every change of sides.

    """
    change = toll * np.array([[0.0, 1.0], [1.0, 0.0]])
    total = np.array([[0.0, toll], [np.inf, np.inf]])  # by what the last two frames are
    came_from = np.empty((len(missed), 2, 2), dtype=np.intp)
    for step, costs in enumerate(missed):
        ways = total[:, :, None] + costs + change
        came_from[step] = ways.argmin(axis=0)
        total = ways.min(axis=0)
    before, last = np.unravel_index(int(total.argmin()), (2, 2))
    path = [int(last), int(before)]
    for step in range(len(missed) - 1, -1, -1):
        path.append(int(came_from[step, path[-1], path[-2]]))
    return np.array(path[::-1], dtype=bool)
