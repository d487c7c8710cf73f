"""Voter `arm_path`: the paths of elbows and wrists in time, aligned by DTW."""

from __future__ import annotations

from app.recognition.features.motion import Movement, normalize_figure
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import DtwVoter


class ArmPath(DtwVoter):
    """DTW distance between the paths of elbows and wrists at equal times.

    Unlike `Path`, it compares all joints of both arms, whichever are salient, at equal times: an
    elbow's share in a movement distinguishes whole arms, and the steps keep their speed.
    """

    name = "arm_path"
    unit = "mean squared distance along the alignment, in squared sizes of the movement"
    prior = 1.0
    within = 0.11
    between = 1.0
    cue = "movement"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 A)`` coordinates in sizes, NaN where not seen."""
        return normalize_figure(movement.places).reshape(len(movement.places), -1)
