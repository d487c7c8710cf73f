"""Hand voters: compare the shapes of single hands, as seen in the image."""

from __future__ import annotations

from abc import abstractmethod
from itertools import combinations

import numpy as np

from app.recognition.features.trajectory_image import FINGER_BONES
from app.recognition.poses.frame import HandShape
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.voter import WeightedVoter, euclidean_distances

MOST_TURNED = 30.0
"""Degrees by which a hand may be turned in the image at no cost: nobody holds a sign more upright
than that. With 20 degrees fewer letters of other signers are nearest right, with 45 more divers'
signs are confused (`benchmarks/studies/hand-shapes.md`)."""

_STARTS, _ENDS = ([bone[end] for bone in FINGER_BONES] for end in range(2))

_ONE, _OTHER = zip(
    *combinations([HAND_LANDMARKS.index(name) for name in HAND_LANDMARKS if "tip" in name], 2),
    strict=True,
)


class HandVoter(WeightedVoter):
    """Base of hand voters, whose descriptors are D vectors in the image.

    These are complex numbers ``x + jy`` with real and imaginary parts apart, whose squares sum to
    1. A query is turned by up to `MOST_TURNED` degrees to where it fits best; beyond, the
    orientation counts, which tells up from down.

    `within` is the mean distance between takes of two signers of a letter, or of two views of a
    diver's sign, `between` the median between two letters or signs; the geometric mean of both.
    """

    @abstractmethod
    def describe(self, hand: HandShape) -> FloatArray:
        """Return the descriptor of a hand, ``(2 D,)`` of D vectors."""

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return the Euclidean distances at the best turn, ``(M,)`` between 0 and 2."""
        return self.distances_turned(query, references, MOST_TURNED)

    def distances_turned(
        self, query: FloatArray, references: FloatArray, most_turned: float
    ) -> FloatArray:
        """Return the distances where a turn by up to `most_turned` degrees costs nothing.

        Parameters and result as for `distances`.
        """
        half = len(query) // 2
        own = query[:half] - 1j * query[half:]
        product = (references[:, :half] + 1j * references[:, half:]) @ own
        turn = np.radians(most_turned)
        best = np.abs(product) * np.cos(np.maximum(np.abs(np.angle(product)) - turn, 0.0))
        energy = 2 * np.sqrt((query @ query) * np.vecdot(references, references))
        # A difference of nearly equal sums: rounding errors are set to 0.
        squares = energy - 2 * best
        squares[squares < 1e-12 * energy] = 0.0
        return np.asarray(np.sqrt(squares), dtype=np.float64)


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

    def describe(self, hand: HandShape) -> FloatArray:
        """Return the landmarks' places, ``(42,)``."""
        return _describe_vectors(hand.xy - hand.xy.mean(axis=0), hand.palm)


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

    def describe(self, hand: HandShape) -> FloatArray:
        """Return the bones' directions, ``(40,)``."""
        bones = hand.xy[_ENDS] - hand.xy[_STARTS]
        lengths = np.maximum(np.linalg.norm(bones, axis=1), 1e-9)
        return _describe_vectors(bones / lengths[:, None], hand.palm)


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

    def describe(self, hand: HandShape) -> FloatArray:
        """Return the distances of all pairs of tips, ``(10,)`` in palms."""
        apart = hand.xy[[*_ONE]] - hand.xy[[*_OTHER]]
        return np.asarray(np.linalg.norm(apart, axis=1) / max(hand.palm, 1e-9))

    def distances_turned(
        self, query: FloatArray, references: FloatArray, most_turned: float
    ) -> FloatArray:
        """Return the Euclidean distances, which no turn changes."""
        return euclidean_distances(query, references)


def _describe_vectors(vectors: FloatArray, palm: float) -> FloatArray:
    """Return the descriptor of vectors ``(D, 2)``, ``(2 D,)``: of length 1 / `palm`."""
    parts = vectors.T.ravel()
    return np.asarray(parts / max(palm * float(np.sqrt(parts @ parts)), 1e-12))
