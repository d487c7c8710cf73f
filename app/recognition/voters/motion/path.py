"""Voter `path`: the paths of the salient landmarks, aligned by DTW."""

from __future__ import annotations

from app.recognition.features.motion import Movement
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import DtwVoter


class Path(DtwVoter):
    """DTW distance between the paths, independent of position and size (Sakoe and Chiba 1978).

    Each landmark's path is relative to its own mean; all are divided by one size, the root of the
    mean over the steps of the summed squares. ``1/N sum |q - r|^2`` along the best alignment.
    """

    name = "path"
    unit = "mean squared distance along the alignment, in squared sizes of the gesture"
    prior = 0.0
    within = 0.1
    between = 1.1
    cue = "movement"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 L)`` coordinates in sizes."""
        return movement.figure.reshape(len(movement.paths), -1)
