"""Take comparison: features of a take relative to its demonstration, by voters and by form."""

from __future__ import annotations

import numpy as np

from app.recognition import Gesture, PoseSequence
from app.recognition.decision.fused_vote import FusedVote
from app.recognition.features.motion import build_movement
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.registry import VOTER_NAMES

LOOKS = ("duration", "way", "unevenness", "corners", "opening", "roughness")
"""Features of a take by itself, see `looks`."""

SCORE = "score"
"""The fused score in a language of the one gesture: 1 is as far as two gestures usually are."""

FEATURES = (*VOTER_NAMES, SCORE, *LOOKS)


class TakeComparison:
    """Measures takes against one demonstration.

    Parameters
    ----------
    gesture
        With a demonstration.

    """

    def __init__(self, gesture: Gesture) -> None:
        self.demonstration = demonstration_of(gesture)
        self._salient = gesture.salient
        self._vote = FusedVote([gesture])
        self._looks = looks(self.demonstration, gesture.salient)

    def features(self, take: Trajectory) -> FloatArray:
        """Return ``(F,)`` numbers, named by `FEATURES`.

        Distances are in the nearest traversal; `looks` are given as differences.
        """
        compared = self._vote.compare(take)
        seen = looks(take, self._salient) - self._looks
        return np.concatenate([compared.distances[:, 0], compared.scores, seen])

    def of_recording(self, poses: PoseSequence) -> FloatArray:
        """Return the features of a recorded take."""
        take = condense(Trajectory.from_poses(poses))
        return self.features(take.select(self.demonstration.landmarks))


def demonstration_of(gesture: Gesture) -> Trajectory:
    """Return a gesture's demonstration; gestures made from poses always have one."""
    assert gesture.trajectory is not None
    return gesture.trajectory


def looks(take: Trajectory, salient: tuple[str, ...]) -> FloatArray:
    """Describe a take by itself, by the logarithms of these features.

    Its duration; the length of its path in sizes; the unevenness of its speed (spread over mean);
    its turning (mean squared angle from step to step); the gap between start and end in sizes; and
    the difference to the smoothed path in sizes.
    """
    seen = build_movement(take, salient)
    steps = np.diff(seen.paths, axis=0)
    size = np.sqrt((seen.paths**2).sum(axis=(1, 2)).mean())
    lengths = np.sqrt((steps**2).sum(axis=(1, 2)))
    speeds = lengths / np.maximum(np.diff(seen.reached), 1e-3)
    units = steps / np.maximum(lengths, 1e-9)[:, None, None]
    turns = 1 - (units[1:] * units[:-1]).sum(axis=(1, 2))
    opening = np.sqrt(((seen.paths[-1] - seen.paths[0]) ** 2).sum())
    paths = take.select(salient).resample_in_time(64).xy
    rough = paths[1:-1] - (paths[2:] + paths[:-2]) / 2
    values = [
        seen.duration,
        lengths.sum() / size,
        speeds.std() / speeds.mean(),
        turns.mean(),
        0.05 + opening / size,
        np.sqrt(np.nanmean(rough**2)) / size,
    ]
    return np.asarray(np.log(np.maximum(values, 1e-4)), dtype=np.float64)
