"""Movements as equal steps: the input of all methods but ours and the published one.

All landmarks together, resampled to steps of equal length along their joint path, centred and
scaled by one size. The methods then differ in how they compare, not in how they were prepared.
"""

from __future__ import annotations

import numpy as np

from app.recognition import PoseError
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory

STEPS = 32
"""Number of steps, as in profile ``full``."""


def even_positions(trajectory: Trajectory, count: int = STEPS) -> FloatArray:
    """Resample to `count` steps of equal length: ``(count, K, 2)``, of mean 0 and of size 1.

    Raises
    ------
    PoseError
        When a landmark is missing at the beginning or the end.

    """
    even = trajectory.fill_gaps(np.inf).resample_in_arc_length(count).xy
    if not np.isfinite(even).all():
        raise PoseError("the methods compared with need every landmark from first to last frame")
    centred = even - even.mean(axis=(0, 1))
    size = np.sqrt((centred**2).sum(axis=(1, 2)).mean())
    return np.asarray(centred / max(size, 1e-9))


def directions(positions: FloatArray) -> FloatArray:
    """Return the joint unit vector of all landmarks' velocities at each step, ``(N, K, 2)``."""
    steps = np.gradient(positions, axis=0)
    return np.asarray(steps / (np.sqrt((steps**2).sum(axis=(1, 2), keepdims=True)) + 1e-9))


def features(trajectory: Trajectory) -> FloatArray:
    """Return positions and directions of each step side by side, ``(STEPS, 4 K)``."""
    positions = even_positions(trajectory)
    both = np.concatenate([positions, directions(positions)], axis=1)
    return both.reshape(STEPS, -1)
