"""Voter `hand_attitude`: where fingers and thumbs point, aligned by DTW."""

from __future__ import annotations

from app.recognition.features.motion import LIMBS, Movement, normalize_size
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import DtwVoter

HAND_BONES = [index for index, (inner, _) in enumerate(LIMBS) if inner == "wrist"]
"""Indices of an arm's bones beyond the wrist."""


class HandAttitude(DtwVoter):
    """DTW distance between the hands' attitudes: where fingers and thumb point (as `Posture`).

    Only the bones beyond the wrist, divided by their own size, because a thumb up or down is small
    beside the arm that raises it. Steps weigh more the farther they are from the start.
    """

    name = "hand_attitude"
    unit = "mean squared difference of the hands' bones along the alignment, in squared sizes"
    prior = 0.0
    within = 0.18
    between = 0.56

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 B')`` vectors in sizes, NaN where not seen."""
        steps = len(movement.limbs)
        arms = movement.limbs.reshape(steps, -1, len(LIMBS), 2)
        hands = arms.take(HAND_BONES, axis=2).reshape(steps, -1, 2)
        return (normalize_size(hands) * movement.under_way[:, None, None]).reshape(steps, -1)
