"""Voter `finger_directions`: where the bones of a held hand's fingers point."""

from __future__ import annotations

import numpy as np

from app.recognition.features.hand_image import FINGER_BONES
from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.hand.hand_voter import HandVoter, describe_vectors

_STARTS, _ENDS = ([bone[end] for bone in FINGER_BONES] for end in range(2))


class FingerDirections(HandVoter):
    """Distance between the directions of the 20 bones from the wrist to the fingertips.

    Each has length 1, so that a finger seen from the front, or a bent thumb, counts as much as a
    stretched finger.
    """

    name = "finger_directions"
    unit = "root mean squared difference of unit vectors"
    prior = 1.0
    within = 0.2
    between = 0.57
    cue = "hand"

    def describe(self, hand: HandShape) -> FloatArray:
        """Return the bones' directions, ``(40,)``."""
        bones = hand.xy[_ENDS] - hand.xy[_STARTS]
        lengths = np.maximum(np.linalg.norm(bones, axis=1), 1e-9)
        return describe_vectors(bones / lengths[:, None], hand.palm)
