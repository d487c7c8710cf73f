"""Quality check: refuses poses that are too poor to recognise after `repair`.

A refusal with a reason is better than the nearest gesture, which would be a guess.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import MAX_GAP_SECONDS, FloatArray, PoseSequence
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.outliers import measure_body_unit
from app.recognition.text.wording import humanize

FEWEST_FRAMES = 5
"""Least number of frames: the simplest gestures are two strokes of three frames that share a
corner."""

LEAST_FOLLOWED = 0.5
"""Least share of the time in which a landmark must be seen, gaps of half a second bridged. Losing
60 % of frames at random costs a few per cent of accuracy (`benchmarks/studies/damage.md`)."""

LEAP = 1.0
"""Torso lengths from one frame to the next, within `LEAP_SECONDS`, that no hand moves: the fastest
0.1 s of quick swipes span half of that."""

LEAP_SECONDS = 0.1
"""Longest time between two frames in which a leap differs from a stroke."""

MOST_LEAPS = 0.2
"""Largest share of steps that may be leaps. Repair leaves them only if more than a quarter of a
landmark's positions are outliers."""


QualityFaultKind = Literal["few_frames", "nothing_seen", "not_followed", "leaps", "unseen_hand"]


@dataclass(frozen=True)
class QualityFault:
    """Why poses are too poor to recognise.

    Attributes
    ----------
    kind
        Too few frames, nothing seen, a landmark not followed for long enough or leaping about, or
        no hand seen although its shape counts.
    words
        A clause for users with the values seen.

    """

    kind: QualityFaultKind
    words: str


def find_fault(
    poses: PoseSequence, landmarks: Sequence[str], trajectory: Trajectory | None = None
) -> QualityFault | None:
    """Return why poses are too poor to recognise, or None.

    Parameters
    ----------
    poses
        Repaired poses.
    landmarks
        The salient landmarks of the gesture in question; those that `poses` lacks are ignored.
    trajectory
        The trajectory of `poses`, if it is computed already.

    """
    if len(poses) < FEWEST_FRAMES:
        words = f"it has {len(poses)} frames, and at least {FEWEST_FRAMES} are needed"
        return QualityFault("few_frames", words)
    if not poses.seen.any():
        words = f"none of its {len(poses)} frames shows a landmark"
        return QualityFault("nothing_seen", words)
    if trajectory is None:
        trajectory = Trajectory.from_poses(poses)
    unit = measure_body_unit(trajectory)
    for name in landmarks:
        if name not in poses.landmarks:
            continue
        index = trajectory.landmarks.index(name)
        time, places = trajectory.time, trajectory.xy[:, index]
        if not np.isfinite(places).all():
            seen = np.flatnonzero(np.isfinite(places).all(axis=1))
            followed = _sum_followed_time(time, seen) / poses.duration
            if followed < LEAST_FOLLOWED:
                only = f"only {followed:.0%} of its {poses.duration:.1f} s"
                words = f"the {humanize(name)} is followed for {only}"
                return QualityFault("not_followed", words)
            time, places = time[seen], places[seen]
        lasts = time[1:] - time[:-1]
        steps = places[1:] - places[:-1]
        far = np.vecdot(steps, steps) > (LEAP * unit) ** 2
        leaps = np.count_nonzero(far & (lasts <= LEAP_SECONDS)) / len(lasts)
        if leaps > MOST_LEAPS:
            words = f"the {humanize(name)} leaps over a torso length in {leaps:.0%} of its frames"
            return QualityFault("leaps", words)
    return None


def _sum_followed_time(time: FloatArray, seen: npt.NDArray[np.intp]) -> float:
    """Sum the seconds between moments at which a landmark was seen, without longer gaps."""
    lasts = np.diff(time[seen])
    bridged = (lasts <= MAX_GAP_SECONDS) | (np.diff(seen) == 1)
    return float(lasts[bridged].sum())
