"""Voter `hand_landmarks`: where the landmarks of a held hand are."""

from __future__ import annotations

from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.hand.hand_voter import HandVoter, describe_vectors


class HandLandmarks(HandVoter):
    """Distance between the 21 landmarks of two hands with the same centroid and size.

    The full Procrustes distance (Kendall 1984) with the turn limited: fingertips are farthest from
    the centroid and count most.
    """

    name = "hand_landmarks"
    unit = "distance between landmarks, in sizes of the hand"
    prior = 1.0
    within = 0.15
    between = 0.51
    cue = "hand"

    def describe(self, hand: HandShape) -> FloatArray:
        """Return the landmarks' places, ``(42,)``."""
        return describe_vectors(hand.xy - hand.xy.mean(axis=0), hand.palm)
