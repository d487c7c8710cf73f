"""Voter `tempo`: the duration of the movement."""

from __future__ import annotations

import numpy as np

from app.recognition.features.motion import Movement
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import MotionVoter
from app.recognition.voters.voter import absolute_differences

SHORTEST_SECONDS = 0.05
"""Lower limit of durations, two frames, for the logarithm."""


class Tempo(MotionVoter):
    """Difference of durations."""

    name = "tempo"
    unit = "doublings of the duration"
    prior = 0.0
    within = 0.38
    between = 0.5
    weight_where_needed = 0.3
    """Amount added to the score per doubling of the duration, for a gesture whose tempo counts:
    more than the distance of two takes (0.1), less than that of two gestures (1)."""

    def describe(self, movement: Movement) -> FloatArray:
        """Return the logarithm to base 2 of the seconds, ``(1,)``."""
        return np.log2([max(movement.duration, SHORTEST_SECONDS)])

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return absolute differences, ``(M,)``."""
        return absolute_differences(query, references)
