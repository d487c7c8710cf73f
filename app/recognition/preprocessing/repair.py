"""Repair: corrects side swaps and removes outliers of landmarks, in demonstrations and queries.

`repair_poses` exchanges back the landmarks of side swaps (`find_side_swaps`), and makes outliers
NaN (`outliers`). No positions are invented. Gaps are bridged later by `Trajectory.fill_gaps`, and
jitter is smoothed by `build_movement`.

A side swap is a frame in which the pose model took left for right. Without a face in view the model
confuses the sides for a frame or for many; both hands then jump to each other's position and back.
Hands that really meet or cross keep their velocity, so the frames to exchange are those that give
the least sum of accelerations (Viterbi 1967). Positions are in single precision, exact to a
millionth of a torso length, in half the time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from app.recognition.features.motion import parse_body_part
from app.recognition.poses.landmarks import SHOULDERS, other_side
from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.outliers import find_outliers, measure_body_unit
from app.recognition.text.wording import list_some


def median(values: FloatArray) -> float:
    """Return the median of ``(N,)`` finite numbers, N > 0.

    The same value as `numpy.median`, which takes ten times as long for a hundred numbers because
    it handles axes, masks and NaN.
    """
    ordered, half = np.sort(values), len(values) // 2
    return float((ordered[half] + ordered[-half - 1]) / 2)


TOLL = 0.5
"""Cost of each change between normal and exchanged frames, in distances between the sides.

A swapped frame costs several such distances. One in 500 undamaged two-handed recordings is changed;
from a cost of 1 on, a tenth of the swapped frames is missed (`benchmarks/studies/damage.md`).
"""

TREMBLES = 3.0
"""Least cost of a change as a multiple of the usual acceleration: with trembling landmarks, two
hands beside each other can seem steadier exchanged."""

MOST_EXCHANGED = 0.5
"""Share of exchanged frames beyond which the other frames are taken as swapped."""

UNSEEN_SPEED = 5.0
"""Torso lengths a second that hands without a body may move while not seen: a quick stroke.

With 3 or less, one in twenty recordings of two hands with gaps is changed."""

FRONTAL = 0.25
"""Least torso lengths between the shoulders at which they show a frontal view."""

BLENDED = 0.9
"""Share of the median shoulder width below which a frame beside swapped ones is blended: the pose
model's smoothing mixes both sides. From 0.88 to 0.94 a frame or two differ; with less, a blended
frame remains and adds a stroke."""

ELBOWS = ("left_elbow", "right_elbow")

ARMS_BLENDED = 0.95
"""Share of the elbows' distance before and after below which a frame beside swapped ones has
blended arms. From 0.9 to 0.97 the sample clip that needs it is recognised on every processor."""

BLEND_SECONDS = 0.25
"""Longest time from a blended frame to one that shows the arms apart: a pose model's smoothing
has settled by then (from 0.2 to 0.4 s the result is the same)."""

LONGEST_BLEND = 2 * BLEND_SECONDS
"""Seconds from which narrow shoulders are a turn of the body and no blend. Of 320 takes of
`utd_other`, four turned ones lost a third of their frames, which cost the languages that they
demonstrate 2 points of accuracy."""

Mask: TypeAlias = npt.NDArray[np.bool_]
SingleArray: TypeAlias = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class SideSwaps:
    """The side swaps of T frames.

    Attributes
    ----------
    exchanged
        ``(T,)``: left and right are exchanged.
    blended
        ``(T,)``: the sides are mixed, between a swapped frame and a correct one.

    """

    exchanged: Mask
    blended: Mask


@lru_cache(maxsize=64)
def pair_sides(landmarks: tuple[str, ...]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the indices of the landmarks of the left side, and of their counterparts."""
    parts = [parse_body_part(name) for name in landmarks]
    left = tuple(
        index
        for index, part in enumerate(parts)
        if "left" in part.split("_") and other_side(part) in parts
    )
    return left, tuple(parts.index(other_side(parts[index])) for index in left)


@lru_cache(maxsize=64)
def _coordinates_of_sides(landmarks: tuple[str, ...]) -> npt.NDArray[np.intp]:
    """Return the indices of both sides' coordinates among all coordinates: ``(2, 2, K)``.

    First all x, then all y, of each the left side's before the right one's, so that summed values
    are contiguous in memory.
    """
    sides = 2 * np.array(pair_sides(landmarks), dtype=np.intp)
    return np.stack([sides, sides + 1])


def find_side_swaps(trajectory: Trajectory) -> SideSwaps:
    """Find the frames in which the pose model took left for right.

    All landmarks are exchanged together, because the model confuses the whole body. Frames without
    landmarks are never swapped, nor are trajectories of one side or of fewer than three frames.
    """
    frames = len(trajectory)
    none = SideSwaps(np.zeros(frames, dtype=bool), np.zeros(frames, dtype=bool))
    sides = _coordinates_of_sides(trajectory.landmarks)
    if not sides.size:
        return none
    xy = trajectory.xy.reshape(frames, -1).take(sides, axis=1).astype(np.float32)
    blended = _find_blended(trajectory)
    known = np.isfinite(xy)
    clear = (~blended if known.all() else known.any(axis=(1, 2, 3)) & ~blended).nonzero()[0]
    if len(clear) < 3:
        return none
    xy = xy if len(clear) == frames else xy[clear]
    if (unit := measure_body_unit(trajectory)) != 1.0:
        xy = xy / unit
    between = _measure_lengths(xy[:, :, 0] - xy[:, :, 1])
    toll = TOLL * median(np.add.reduce(between, axis=1, dtype=np.float64))
    # With a body in view the trunk shows the sides after a gap, so hands get no allowance.
    speed = 0.0 if set(SHOULDERS) <= set(trajectory.landmarks) else UNSEEN_SPEED
    accelerations = _Accelerations.between(xy, trajectory.time[clear], speed)
    kept = accelerations.of(0, 0, 0)
    toll = max(toll, TREMBLES * median(kept))
    # A change of sides saves at most the two accelerations around it.
    if (kept[1:] + kept[:-1]).max(initial=kept[0]) <= toll:
        return none
    swapped = _find_steadiest(accelerations.of_all(), toll)
    if not swapped.any():
        return none
    if swapped.mean() > MOST_EXCHANGED:
        swapped = ~swapped
    exchanged = none.exchanged.copy()
    exchanged[clear] = swapped
    return SideSwaps(exchanged, blended | _find_blended_arms(trajectory, blended))


def swap_sides(values: FloatArray, landmarks: tuple[str, ...], frames: Mask) -> FloatArray:
    """Exchange the values of the left and right landmarks in some frames.

    Parameters
    ----------
    values
        ``(T, K, ...)``, of each landmark in each frame.
    landmarks
        K names.
    frames
        ``(T,)``: the frames to exchange, see `SideSwaps.exchanged`.

    """
    left, right = pair_sides(landmarks)
    order = np.arange(len(landmarks))
    order[[*left, *right]] = [*right, *left]
    changed = values.copy()
    changed[frames] = values[frames][:, order]
    return changed


def _find_blended(trajectory: Trajectory) -> Mask:
    """Return ``(T,)``: frames in which the shoulders are too close to each other.

    Frames that are so for longer than a pose model's smoothing show a diver who turns.
    """
    if not set(SHOULDERS) <= set(trajectory.landmarks):
        return np.zeros(len(trajectory), dtype=bool)
    first, second = (trajectory.landmarks.index(name) for name in SHOULDERS)
    across = trajectory.xy[:, first] - trajectory.xy[:, second]
    width = np.sqrt(np.vecdot(across, across))
    known = width[np.isfinite(width)]
    usual = median(known) if len(known) else 0.0
    narrow = np.asarray(width < (BLENDED * usual if usual > FRONTAL else 0.0))
    bounds = np.flatnonzero(np.diff(narrow, prepend=False, append=False)).reshape(-1, 2)
    for start, end in bounds.tolist():
        if trajectory.time[end - 1] - trajectory.time[start] > LONGEST_BLEND:
            narrow[start:end] = False
    return narrow


def _find_blended_arms(trajectory: Trajectory, blended: Mask) -> Mask:
    """Return ``(T,)``: frames whose elbows are closer together than shortly before and after.

    The model's smoothing mixes arms for longer than shoulders, which are closer together. Swapped
    sides do not change the distance.

    Parameters
    ----------
    trajectory
        T frames, some of which are swapped.
    blended
        ``(T,)``: frames already known to be blended, which are not compared with.

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
    """Accelerations of landmarks: their distances from constant velocity.

    Attributes
    ----------
    both
        ``(T, 2, 2, K)`` each: x and y of the landmarks of both sides, kept (0) or exchanged (1),
        in torso lengths.
    carried
        ``(T - 2, 1, 1, 1)``: factor on the last step for the expected next one.
    elsewhere
        ``(T - 2, 1, 1)``: torso lengths of free movement in a gap; 0 where none is allowed.

    """

    both: tuple[SingleArray, SingleArray]
    carried: SingleArray
    elsewhere: SingleArray | float

    @classmethod
    def between(cls, xy: SingleArray, time: FloatArray, unseen_speed: float) -> _Accelerations:
        """Prepare for ``(T, 2, 2, K)`` at ``(T,)`` and a speed in gaps, torso lengths a second."""
        steps = time[1:] - time[:-1]
        # After a gap a hand may have stopped, so the expected step is at most the last one, and
        # free movement is allowed.
        share = np.minimum(steps[1:] / steps[:-1], 1.0)
        carried = share.astype(np.float32)[:, None, None, None]
        both = (xy, xy[:, :, ::-1])
        if unseen_speed == 0.0:
            return cls(both, carried, 0.0)
        gaps = np.maximum(steps[1:], steps[:-1]) - median(steps)
        elsewhere = unseen_speed * np.maximum(gaps, 0.0)
        return cls(both, carried, elsewhere.astype(np.float32)[:, None, None])

    def of(self, first: int, second: int, third: int) -> FloatArray:
        """Return their sums, ``(T - 2,)``, for three frames each kept (0) or exchanged (1).

        A landmark that is not seen in all three adds nothing.
        """
        before, last = self.both[first][:-2], self.both[second][1:-1]
        carried_on = last - before
        carried_on *= self.carried
        off = self.both[third][2:] - last
        off -= carried_on
        missed = _measure_lengths(off, self.elsewhere)
        return np.asarray(np.add.reduce(missed, axis=(1, 2), dtype=np.float64))

    def of_all(self) -> FloatArray:
        """Return their sums for every choice: ``(T - 2, 2, 2, 2)``."""
        choices = [self.of(*choice) for choice in np.ndindex(2, 2, 2)]
        return np.stack(choices, axis=1).reshape(-1, 2, 2, 2)


def _measure_lengths(vectors: SingleArray, less: SingleArray | float = 0.0) -> SingleArray:
    """Return the lengths of vectors ``(T, 2, ...)`` minus `less`; 0 if negative or unknown.

    The vectors are overwritten.
    """
    squares = np.multiply(vectors, vectors, out=vectors)
    lengths = squares[:, 0] + squares[:, 1]
    np.sqrt(lengths, out=lengths)
    if isinstance(less, np.ndarray):
        lengths -= less
    return np.asarray(np.fmax(lengths, 0.0, out=lengths))


def _find_steadiest(missed: FloatArray, toll: float) -> Mask:
    """Return ``(T,)``: frames to exchange for the least sum; the first one is never exchanged.

    Parameters
    ----------
    missed
        See `_Accelerations.of_all`.
    toll
        Added for every change of sides.

    """
    change = toll * np.array([[0.0, 1.0], [1.0, 0.0]])
    total = np.array([[0.0, toll], [np.inf, np.inf]])  # by the choice for the last two frames
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


ROUNDS = 16
"""Most rounds of repair: one round can reveal errors for the next. Of 400 recordings with heavy
damage none needed more than nine."""

MOST_NAMED = 3
"""Landmarks named in a sentence about outliers; the others are counted."""


@dataclass(frozen=True, eq=False)
class Repair:
    """Repaired poses of T frames, and what was repaired.

    Attributes
    ----------
    poses
        The repaired poses; the original object where nothing was wrong.
    exchanged
        ``(T,)``: frames whose left and right were exchanged back.
    blended
        ``(T,)``: frames that mix both sides, set to NaN.
    jumps
        ``(T, K)``: outliers, set to NaN.

    """

    poses: PoseSequence
    exchanged: Mask
    blended: Mask
    jumps: Mask

    @cached_property
    def trajectory(self) -> Trajectory:
        """The trajectory of `poses`, computed once.

        Raises
        ------
        PoseError
            When no landmark is seen.

        """
        return Trajectory.from_poses(self.poses)

    @property
    def touched(self) -> Mask:
        """``(T,)``: frames in which anything was repaired."""
        return np.asarray(self.exchanged | self.blended | self.jumps.any(axis=1))

    @property
    def findings(self) -> tuple[str, ...]:
        """The repairs as sentences with counts; empty where nothing was repaired."""
        if not (self.exchanged.any() or self.blended.any() or self.jumps.any()):
            return ()
        frames = f"of {len(self.poses)} frames"
        found = []
        if self.exchanged.any():
            found.append(f"left and right were exchanged back in {self.exchanged.sum()} {frames}")
        if self.blended.any():
            found.append(
                f"{self.blended.sum()} {frames} show left and right mixed and were left out"
            )
        counts = dict(zip(self.poses.landmarks, self.jumps.sum(axis=0).tolist(), strict=True))
        jumping = sorted((name for name in counts if counts[name]), key=lambda name: -counts[name])
        if jumping:
            named = list_some([f"{name} in {counts[name]}" for name in jumping], MOST_NAMED)
            found.append(f"places that landmarks jumped to were left out: {named} {frames}")
        return tuple(found)


def repair_poses(poses: PoseSequence) -> Repair:
    """Correct side swaps and remove outliers.

    Repairing again changes nothing; poses without these errors are returned unchanged. The repair
    does not depend on translation or uniform scaling of the poses, nor on the clock's origin.
    """
    no_frame = np.zeros(len(poses), dtype=bool)
    result = Repair(poses, no_frame, no_frame, np.zeros(poses.seen.shape, dtype=bool))
    if not poses.seen.any():
        return result
    for _ in range(ROUNDS):
        before = result.poses
        for step in (_exchange_sides, _remove_outliers):
            result = step(result)
            if not result.poses.seen.any():
                return result
        if result.poses is before:
            break
    return result


def _exchange_sides(repair: Repair) -> Repair:
    poses = repair.poses
    sides = find_side_swaps(repair.trajectory)
    if not sides.exchanged.any():
        return repair
    xy = swap_sides(poses.xy, poses.landmarks, sides.exchanged)
    xy[sides.blended] = np.nan
    confidence, world = (
        None if values is None else swap_sides(values, poses.landmarks, sides.exchanged)
        for values in (poses.confidence, poses.world)
    )
    hands = None if poses.hands is None else poses.hands.copy()
    if hands is not None:  # they were told apart by the wrists
        hands[sides.exchanged] = hands[sides.exchanged][:, ::-1]
        hands[sides.blended] = np.nan
    return replace(
        repair,
        poses=replace(poses, xy=xy, confidence=confidence, world=world, hands=hands),
        exchanged=repair.exchanged ^ sides.exchanged,
        blended=repair.blended | sides.blended,
    )


def _remove_outliers(repair: Repair) -> Repair:
    poses = repair.poses
    off = find_outliers(repair.trajectory.select(poses.landmarks))
    if not off.any():
        return repair
    xy = np.where(off[..., None], np.nan, poses.xy)
    return replace(repair, poses=replace(poses, xy=xy), jumps=repair.jumps | off)
