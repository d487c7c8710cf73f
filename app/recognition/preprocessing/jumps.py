"""Jumps: moments of a take at which keypoints leapt away and back, or show another body.

Repair removes outliers of at most a quarter of a second. What is left and still leaps farther than
any hand moves in a frame is found here, for explanations and for faults of demonstrations.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from app.recognition.poses.gaps import MAX_GAP_SECONDS, fill_all_gaps
from app.recognition.poses.landmarks import HIPS, SHOULDERS, TORSO
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.outliers import measure_body_unit

FASTEST = 12.0
"""Torso lengths a second that no hand of a diver reaches: 6 m/s, a hand that throws."""

LEAST_LEAP = 0.4
"""Torso lengths of the shortest leap; two positions of a noisy landmark are nearer."""

SURE_LEAP = 1.0
"""Torso lengths of a leap that needs no rest around it."""

ALONE = 3.0
"""How many times longer than the steps before and after it a shorter leap is: a quick hand
gathers speed, a keypoint does not."""

LONGEST_AWAY = 1.0
"""Most seconds between a leap away and the leap back."""

RETURNED = 1.0
"""Largest distance after the leap back from where the landmark was before, as a share of the
shorter leap; the hand moves on meanwhile."""

FASTEST_BODY = 6.0
"""Torso lengths a second that no diver's body reaches within the picture: 3 m/s."""

OTHER_SIZE = 1.35
"""Ratio of torso lengths from which a moment shows another body; a diver who leans towards the
camera or away from it changes by less."""

Mask: TypeAlias = npt.NDArray[np.bool_]


def find_leaps(trajectory: Trajectory, landmarks: Sequence[str], fastest: float = FASTEST) -> Mask:
    """Find the steps at which one of the landmarks leaps.

    Parameters
    ----------
    trajectory
        At the moments of its frames.
    landmarks
        Names; those that the trajectory lacks are ignored.
    fastest
        Torso lengths a second beyond which a step is a leap.

    Returns
    -------
    ``(T,)``: whether a landmark leaps between the moment before and this one; the first is False.

    """
    leaps = np.zeros(len(trajectory), dtype=bool)
    unit = measure_body_unit(trajectory)
    for name in landmarks:
        if name not in trajectory.landmarks:
            continue
        path = trajectory.select([name]).xy[:, 0] / unit
        seen = np.flatnonzero(np.isfinite(path).all(axis=1))
        lasts = np.diff(trajectory.time[seen])
        far = np.linalg.norm(np.diff(path[seen], axis=0), axis=1)
        framed = np.concatenate([[0.0], far, [0.0]])
        alone = (far > ALONE * np.maximum(framed[:-2], framed[2:])) | (far > SURE_LEAP)
        sudden = alone & (far > LEAST_LEAP) & (far > fastest * lasts) & (lasts <= MAX_GAP_SECONDS)
        leaps[seen[1:][sudden]] = True
    return leaps


def find_unsteady(
    trajectory: Trajectory,
    landmarks: Sequence[str],
    *,
    fastest: float = FASTEST,
    longest: float = LONGEST_AWAY,
) -> Mask:
    """Find the moments at which one of the landmarks is away, between a leap and the leap back.

    Parameters
    ----------
    trajectory, landmarks, fastest
        As for `find_leaps`.
    longest
        Most seconds between the two leaps.

    Returns
    -------
    ``(T,)``; after such a stretch the landmark is nearer to where it was before than meanwhile.

    """
    away = np.zeros(len(trajectory), dtype=bool)
    for name in landmarks:
        leaps = np.flatnonzero(find_leaps(trajectory, [name], fastest)).tolist()
        if len(leaps) < 2:
            continue
        path = fill_all_gaps(trajectory.select([name]).xy, trajectory.time)[:, 0]
        pairs = sorted(combinations(leaps, 2), key=lambda pair: pair[1] - pair[0])
        for first, last in pairs:
            if trajectory.time[last] - trajectory.time[first] > longest or away[first:last].any():
                continue
            out, back = (np.linalg.norm(path[at] - path[at - 1]) for at in (first, last))
            if np.linalg.norm(path[last] - path[first - 1]) < RETURNED * min(out, back):
                away[first:last] = True
    return away


def find_other_body(trajectory: Trajectory) -> Mask:
    """Find the moments that show another body: the torso leaps away, or has another size.

    Returns
    -------
    ``(T,)``; nothing without a torso.

    """
    other = np.zeros(len(trajectory), dtype=bool)
    if trajectory.unit != "torso_length":
        return other
    half = float(trajectory.time[-1] - trajectory.time[0]) / 2
    other |= find_unsteady(trajectory, [TORSO], fastest=FASTEST_BODY, longest=half)
    if {*SHOULDERS, *HIPS} <= set(trajectory.landmarks):
        shoulders, hips = (trajectory.select(pair).xy.mean(axis=1) for pair in (SHOULDERS, HIPS))
        size = np.linalg.norm(shoulders - hips, axis=1)
        usual = np.nanmedian(size) if np.isfinite(size).any() else 1.0
        ratio = np.nan_to_num(size / usual, nan=1.0)
        other |= (ratio > OTHER_SIZE) | (ratio < 1 / OTHER_SIZE)
    return other
