"""Voter `fingertip_distances`: how far the tips of a held hand's fingers are from each other."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.hand.hand_voter import HandVoter
from app.recognition.voters.voter import euclidean_distances

_ONE, _OTHER = zip(
    *combinations([HAND_LANDMARKS.index(name) for name in HAND_LANDMARKS if "tip" in name], 2),
    strict=True,
)


class FingertipDistances(HandVoter):
    """Distance between the ten distances of the fingertips from each other, in palms.

    They are the same however the hand is turned in the image: other people hold a shape at another
    angle, and are told apart by which fingers are spread, side by side, or touch the thumb.
    """

    name = "fingertip_distances"
    unit = "distance between distances of fingertips, in palms"
    prior = 1.0
    within = 0.5
    between = 1.74
    cue = "hand"

    def describe(self, hand: HandShape) -> FloatArray:
        """Return the distances of all pairs of tips, ``(10,)`` in palms."""
        apart = hand.xy[[*_ONE]] - hand.xy[[*_OTHER]]
        return np.asarray(np.linalg.norm(apart, axis=1) / max(hand.palm, 1e-9))

    def distances_turned(
        self, query: FloatArray, references: FloatArray, most_turned: float
    ) -> FloatArray:
        """Return the Euclidean distances, which no turn changes."""
        return euclidean_distances(query, references)
