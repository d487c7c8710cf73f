"""Repair: corrects side swaps and removes outliers of landmarks, in demonstrations and queries.

Two errors of pose models are repaired: side swaps (`side_swaps`) and outliers (`outliers`). No
positions are invented: swapped landmarks are exchanged back, and outliers become NaN. Gaps are
bridged later by `Trajectory.fill_gaps`, and jitter is smoothed by `build_movement`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.outliers import find_outliers
from app.recognition.preprocessing.side_swaps import find_side_swaps, swap_sides
from app.recognition.text.wording import list_some

ROUNDS = 16
"""Most rounds of repair: one round can reveal errors for the next. Of 400 recordings with heavy
damage none needed more than nine."""

MOST_NAMED = 3
"""Landmarks named in a sentence about outliers; the others are counted."""

Mask: TypeAlias = npt.NDArray[np.bool_]


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
