"""Quality: whether a recording shows enough of a gesture to be judged by.

Repair (`repair`) puts right what can be known. What is left may still be too little: then saying so
is the right answer, and the nearest gesture would be a guess.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import FloatArray, PoseSequence
from app.recognition.poses.trajectory import MAX_GAP_SECONDS, Trajectory
from app.recognition.preprocessing.outliers import measure_body_unit
from app.recognition.text.wording import humanize

FEWEST_FRAMES = 5
"""Frames of a recording, at least: a corner takes three, and the simplest gestures have two strokes
of three frames, with the corner in both."""

LEAST_FOLLOWED = 0.5
"""Share of the time that a landmark must be followed. With gaps of up to half a second bridged,
losing 60 % of the frames costs a few per cent of the answers (`docs/results.md`); what lies in
longer gaps is not there at all."""

LEAP = 1.0
"""Torso lengths from one frame to the next, within `LEAP_SECONDS`, that no hand goes: of quick
swipes the fastest 0.1 s span half of that."""

LEAP_SECONDS = 0.1
"""Longest time between two frames in which a leap can be told from a stroke."""

MOST_LEAPS = 0.2
"""Share of the steps that may be leaps. Repair leaves them only where more than a quarter of a
landmark's places were misplaced."""


def find_fault(
    poses: PoseSequence, landmarks: Sequence[str], trajectory: Trajectory | None = None
) -> str | None:
    """Tell what makes a recording too poor to judge.

    Parameters
    ----------
    poses
        The recording, repaired.
    landmarks
        What the gesture in question is shown with; those that the recording lacks are passed over.
    trajectory
        What the recording shows, where that is known already.

    Returns
    -------
    A clause with the values seen, for people; None where nothing is too poor.

    """
    if len(poses) < FEWEST_FRAMES:
        return f"it has {len(poses)} frames, and at least {FEWEST_FRAMES} are needed"
    if not poses.seen.any():
        return f"none of its {len(poses)} frames shows a landmark"
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
            followed = _followed(time, seen) / poses.duration
            if followed < LEAST_FOLLOWED:
                only = f"only {followed:.0%} of its {poses.duration:.1f} s"
                return f"the {humanize(name)} is followed for {only}"
            time, places = time[seen], places[seen]
        lasts = time[1:] - time[:-1]
        steps = places[1:] - places[:-1]
        far = np.vecdot(steps, steps) > (LEAP * unit) ** 2
        leaps = np.count_nonzero(far & (lasts <= LEAP_SECONDS)) / len(lasts)
        if leaps > MOST_LEAPS:
            return f"the {humanize(name)} leaps over a torso length in {leaps:.0%} of its frames"
    return None


def _followed(time: FloatArray, seen: npt.NDArray[np.intp]) -> float:
    """Add up the seconds between moments at which a landmark was seen, without longer gaps."""
    lasts = np.diff(time[seen])
    bridged = (lasts <= MAX_GAP_SECONDS) | (np.diff(seen) == 1)
    return float(lasts[bridged].sum())
