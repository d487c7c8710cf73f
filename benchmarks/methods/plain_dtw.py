"""Plain DTW of the arms' positions, of their velocities, and of both; it stands beside ours."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from app.recognition import PoseSequence
from app.recognition.matching.dtw import dtw_distances
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory

STEPS, BAND = 32, 8
"""Steps that a recording is resampled to in time, and the band of DTW in steps."""

MOVING = ("elbow", "wrist", "hand", "hand_tip", "thumb", "index")
"""Parts of the body that plain DTW follows."""


def positions(poses: PoseSequence) -> FloatArray:
    """Return ``(N, D)`` positions of arms in time: torso lengths from the shoulders' mean place.

    Without a torso they are normalised by place and size.
    """
    trajectory = Trajectory.from_poses(poses)
    arms = [name for name in trajectory.landmarks if name.split("_", 1)[-1] in MOVING]
    centre, length = poses.torso_centre(), poses.torso_length()
    if centre is None or length is None:
        paths = trajectory.select(arms or trajectory.landmarks).fill_gaps().resample_in_time(STEPS)
        free = np.nan_to_num(paths.xy - np.nanmean(paths.xy, axis=0))
        return np.asarray(free.reshape(STEPS, -1) / max(float(np.sqrt((free**2).mean())), 1e-9))
    shoulders = (poses.column("left_shoulder") + poses.column("right_shoulder")) / 2
    fixed = replace(poses.select(arms), xy=poses.select(arms).xy - np.nanmedian(shoulders, axis=0))
    paths = replace(trajectory.select(arms), xy=fixed.xy / length).fill_gaps()
    return np.asarray(np.nan_to_num(paths.resample_in_time(STEPS).xy).reshape(STEPS, -1))


def velocities(poses: PoseSequence) -> FloatArray:
    """Return ``(N, D)`` velocities of arms in time, scaled by their own energy."""
    speed = np.gradient(positions(poses), axis=0)
    return np.asarray(speed / max(float(np.sqrt((speed**2).mean())), 1e-9))


def plain_dtw(templates: Sequence[PoseSequence]) -> Callable[[PoseSequence], dict[str, FloatArray]]:
    """Return a function that measures a take's distances to all templates, by method.

    Distances are over their median between templates.
    """

    def measured(
        describe: Callable[[PoseSequence], FloatArray],
    ) -> Callable[[PoseSequence], FloatArray]:
        references = np.stack([describe(each) for each in templates])
        between = [dtw_distances(each, references, BAND) for each in references]
        typical = float(np.median(np.array(between)[np.triu_indices(len(references), 1)]))
        return lambda poses: dtw_distances(describe(poses), references, BAND) / typical

    of_positions, of_velocities = measured(positions), measured(velocities)

    def compare(poses: PoseSequence) -> dict[str, FloatArray]:
        place, speed = of_positions(poses), of_velocities(poses)
        return {"DTW positions": place, "DTW velocities": speed, "DTW of both": place + speed}

    return compare
