"""Repair of exchanged sides: frames in which the pose model took the left for the right.

Without a face in view the model mistakes the sides for a frame or for many; both hands then jump
to each other's place and back. The repair exchanges the sides where that makes the hands travel
less, by the shortest path through the frames (Viterbi 1967).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from app.recognition.landmarks import SHOULDERS, other_side
from app.recognition.poses import FloatArray
from app.recognition.trajectory import Trajectory

TOLL = 0.25
"""What a change of sides must save at least, as a share of the distance between the sides: a
mistaken frame is a jump of one whole distance, jitter of a tenth. Hands that cross or clap save
nothing when exchanged."""

MOST_EXCHANGED = 0.5
"""Share of the frames beyond which it is the others that are mistaken."""

PARTS = (
    *("shoulder", "elbow", "wrist", "hand", "hand_tip", "index", "pinky", "thumb"),
    *("hip", "knee", "ankle", "heel", "foot_index"),
)
"""What is exchanged together: the model mistakes the whole body."""

BLENDED = 0.85
"""Share of the median width of the shoulders below which a frame of a mistaken recording is between
the two: a pose model's own smoothing blends the sides there, and hands lie before the trunk."""


def with_sides_repaired(trajectory: Trajectory) -> Trajectory:
    """Exchange left and right in the frames in which they were mistaken for each other.

    Frames between a mistaken one and a right one, in which the pose model's smoothing has blended
    the sides, are marked as not seen.

    Returns
    -------
    The trajectory itself where nothing was mistaken, or where no shoulders are among its
    landmarks: hands alone also jump when they only cross.

    """
    names = trajectory.landmarks
    lefts = {f"left_{part}" for part in PARTS}
    left = [i for i, name in enumerate(names) if name in lefts and other_side(name) in names]
    if not set(SHOULDERS) <= set(names) or len(trajectory) < 2:
        return trajectory
    right = [names.index(other_side(names[index])) for index in left]
    clear = np.flatnonzero(~_blended(trajectory))
    here, there = trajectory.xy[clear][:, left], trajectory.xy[clear][:, right]
    apart = np.nansum(np.linalg.norm(here - there, axis=2), axis=1)
    stay = _way(here, here) + _way(there, there)
    jump = _way(here, there) + _way(there, here) + TOLL * float(np.median(apart))
    exchanged = _shortest(stay, jump)
    if not exchanged.any():
        return trajectory
    if exchanged.mean() > MOST_EXCHANGED:
        exchanged = ~exchanged
    xy = np.full_like(trajectory.xy, np.nan)
    xy[clear] = trajectory.xy[clear]
    frames = clear[exchanged][:, None]
    xy[frames, left], xy[frames, right] = there[exchanged], here[exchanged]
    return replace(trajectory, xy=xy)


def _blended(trajectory: Trajectory) -> npt.NDArray[np.bool_]:
    """Tell ``(T,)`` in which frames the shoulders are too close to each other."""
    shoulders = trajectory.select(SHOULDERS).xy
    width = np.linalg.norm(shoulders[:, 0] - shoulders[:, 1], axis=1)
    known = width[np.isfinite(width)]
    return np.asarray(width < BLENDED * float(np.median(known)) if len(known) else width > np.inf)


def _way(before: FloatArray, after: FloatArray) -> FloatArray:
    """Sum what landmarks ``(T, K, 2)`` travel from each frame to the next: ``(T - 1,)``."""
    steps = np.linalg.norm(after[1:] - before[:-1], axis=2)
    return np.asarray(np.nansum(steps, axis=1))


def _shortest(stay: FloatArray, jump: FloatArray) -> npt.NDArray[np.bool_]:
    """Choose ``(T,)`` frames to exchange so that the way is shortest; the first is kept.

    Parameters
    ----------
    stay, jump
        ``(T - 1,)``: the way from a frame to the next where both or none are exchanged, and
        where one of the two is.

    """
    total = np.array([0.0, np.inf])  # up to here, when this frame is kept or exchanged
    came_from = np.zeros((len(stay), 2), dtype=np.intp)
    for step, (same, other) in enumerate(zip(stay, jump, strict=True)):
        ways = total[:, None] + np.array([[same, other], [other, same]])
        came_from[step] = ways.argmin(axis=0)
        total = ways.min(axis=0)
    state = int(total.argmin())
    exchanged = np.zeros(len(stay) + 1, dtype=bool)
    for step in range(len(stay), -1, -1):
        exchanged[step] = bool(state)
        if step:
            state = int(came_from[step - 1, state])
    return exchanged
