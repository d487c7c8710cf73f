"""Voter `velocity`: the velocities of the arms' joints in time, aligned by DTW."""

from __future__ import annotations

from app.recognition.features.motion import Movement, central_differences, normalize_size
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import DtwVoter


class Velocity(DtwVoter):
    """DTW distance between velocities of elbows and wrists at equal times.

    All velocities are divided by one size, the root of their mean square (Taranta et al. 2017,
    Jackknife, without its unit length at each step). Other people repeat when an arm moves fast
    and which joint moves, rather than where it is.
    """

    name = "velocity"
    unit = "mean squared difference along the alignment, in squared mean velocities"
    prior = 1.0
    within = 0.16
    between = 1.1
    cue = "movement"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 A)`` velocities in sizes, NaN where not seen."""
        velocities = central_differences(movement.places)
        return normalize_size(velocities).reshape(len(velocities), -1)
