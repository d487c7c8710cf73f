"""Repair of bad keypoints, the same for demonstrations and queries.

Two faults of pose models are undone: exchanged sides (`sides`) and jumps (`jumps`). Nothing is
invented: exchanged landmarks get each other's places, and what is not believed counts as not seen.
Gaps are bridged where trajectories are made (`Trajectory.filled`), jitter is smoothed where
movements are compared (`movement`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.outliers import find_outliers
from app.recognition.preprocessing.side_swaps import find_side_swaps, swap_sides

ROUNDS = 16
"""Most rounds of looking for faults: what one round takes away shows others. Damaged beyond use,
of 400 recordings none needed more than nine."""

MOST_NAMED = 3
"""Landmarks that are named in a sentence about jumps; the others are counted."""

Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Repair:
    """A repaired recording of T frames, and what was done to it.

    Attributes
    ----------
    poses
        The recording; the one given where nothing was wrong.
    exchanged
        ``(T,)``: left and right were exchanged back.
    blended
        ``(T,)``: lies between the sides, and counts as not seen.
    jumps
        ``(T, K)``: a place that a landmark jumped to, and counts as not seen.

    """

    poses: PoseSequence
    exchanged: Mask
    blended: Mask
    jumps: Mask

    @cached_property
    def trajectory(self) -> Trajectory:
        """What `poses` shows, normalised; made once for all that look at it.

        Raises
        ------
        PoseError
            When they show nothing.

        """
        return Trajectory.from_poses(self.poses)

    @property
    def touched(self) -> Mask:
        """Tell ``(T,)`` in which frames anything was repaired."""
        return np.asarray(self.exchanged | self.blended | self.jumps.any(axis=1))

    @property
    def findings(self) -> tuple[str, ...]:
        """What was repaired, in sentences with counts; empty where nothing was."""
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
            named = ", ".join(f"{name} in {counts[name]}" for name in jumping[:MOST_NAMED])
            others = f" and {len(jumping) - MOST_NAMED} more" if jumping[MOST_NAMED:] else ""
            found.append(f"places that landmarks jumped to were left out: {named}{others} {frames}")
        return tuple(found)


def repair_poses(poses: PoseSequence) -> Repair:
    """Undo exchanged sides, and take out the places that landmarks jumped to.

    Repairing again changes nothing; a recording without these faults is returned as it is.
    Translating or uniformly scaling the recording, and shifting its clock, do not change what is
    repaired.
    """
    no_frame = np.zeros(len(poses), dtype=bool)
    result = Repair(poses, no_frame, no_frame, np.zeros(poses.seen.shape, dtype=bool))
    if not poses.seen.any():
        return result
    for _ in range(ROUNDS):
        before = result.poses
        for mend in (_with_sides_right, _without_jumps):
            result = mend(result)
            if not result.poses.seen.any():
                return result
        if result.poses is before:
            break
    return result


def _with_sides_right(repair: Repair) -> Repair:
    poses = repair.poses
    sides = find_side_swaps(repair.trajectory)
    if not sides.exchanged.any():
        return repair
    xy = swap_sides(poses.xy, poses.landmarks, sides.exchanged)
    xy[sides.blended] = np.nan
    confidence = poses.confidence
    if confidence is not None:
        confidence = swap_sides(confidence, poses.landmarks, sides.exchanged)
    return replace(
        repair,
        poses=replace(poses, xy=xy, confidence=confidence),
        exchanged=repair.exchanged ^ sides.exchanged,
        blended=repair.blended | sides.blended,
    )


def _without_jumps(repair: Repair) -> Repair:
    poses = repair.poses
    off = find_outliers(repair.trajectory)
    if not off.any():
        return repair
    xy = np.where(off[..., None], np.nan, poses.xy)
    return replace(repair, poses=replace(poses, xy=xy), jumps=repair.jumps | off)
