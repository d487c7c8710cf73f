"""Voter: the attitude of the hands, aligned by DTW."""

from __future__ import annotations

from app.recognition.features.motion import LIMBS, Movement, normalize_size
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import DtwVoter
from app.recognition.voters.voter import Cue

HAND_BONES = [index for index, (inner, _) in enumerate(LIMBS) if inner == "wrist"]
"""Bones beyond the wrist, of each arm's."""


class HandAttitude(DtwVoter):
    """DTW distance between the hands' attitudes: where fingers and thumb point (as `Posture`).

    Only the bones beyond the wrist, divided by their own size, and only under way: a thumb up
    against a thumb down is small beside the arm that raises it.
    """

    name = "hand_attitude"
    unit = "mean squared difference of the hands' bones along the alignment, in squared sizes"
    prior = 1.0
    within = 0.13
    between = 0.56
    cue = Cue("posture", weight=2.0, reach=4.0)

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 B')`` vectors in sizes, NaN where not seen."""
        steps = len(movement.limbs)
        arms = movement.limbs.reshape(steps, -1, len(LIMBS), 2)
        hands = arms.take(HAND_BONES, axis=2).reshape(steps, -1, 2)
        return (normalize_size(hands) * movement.under_way[:, None, None]).reshape(steps, -1)
