"""Voter `posture`: where the arms' bones point at each step, aligned by DTW."""

from __future__ import annotations

from app.recognition.features.motion import Movement, normalize_size
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import DtwVoter

RESTING_WEIGHT = 0.3
"""Weight of a posture where the movement starts; at the farthest step it is greater by 1.

From 0.2 to 0.5 the result is the same."""


class Posture(DtwVoter):
    """DTW distance between the arms' postures: where the bones point, step by step.

    Vectors along upper arm, forearm, hand and thumb, divided by one size. Unlike a path they
    distinguish a raised hand from a lowered one. Steps weigh more the farther they are from the
    start, because a gesture's meaning lies in its stroke, not in the arm at rest (Kendon 2004).
    """

    name = "posture"
    unit = "mean squared difference of the limbs along the alignment, in squared sizes"
    prior = 0.0
    within = 0.22
    between = 1.1

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 B)`` vectors in sizes, NaN where not seen; ``(N, 0)`` without limbs."""
        weight = RESTING_WEIGHT + movement.under_way
        return (normalize_size(movement.limbs) * weight[:, None, None]).reshape(len(weight), -1)
