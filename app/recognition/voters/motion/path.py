"""Voter `path`: the paths of the salient landmarks, aligned by DTW."""

from __future__ import annotations

from app.recognition.features.motion import Movement
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import DtwVoter


class Path(DtwVoter):
    """DTW distance between the paths, independent of position and size (Sakoe and Chiba 1978).

    Each landmark's path is relative to its own mean; all are divided by one size, the root of the
    mean over the steps of the summed squares. ``1/N sum |q - r|`` along the best alignment.

    It has weight where hands alone are seen: the paths of whole arms differ between bodies
    (`benchmarks/studies/people.md`).
    """

    name = "path"
    unit = "mean distance along the alignment, in sizes of the gesture"
    prior = 0.5
    within = 0.0
    between = 0.67

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 L)`` coordinates in sizes."""
        return movement.figure.reshape(len(movement.paths), -1)

    def prior_for(self, *, arms: bool) -> float:
        """Return the prior where hands alone are seen, otherwise 0."""
        return 0.0 if arms else self.prior
