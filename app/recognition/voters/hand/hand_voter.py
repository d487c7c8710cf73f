"""Base class of hand voters, which compare hand shapes."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.voter import Voter

MOST_TURNED = 30.0
"""Degrees by which a hand may be turned in the image at no cost: nobody holds a sign more upright
than that. With 20 degrees fewer letters of other signers are nearest right, with 45 more divers'
signs are confused (`benchmarks/studies/hand-shapes.md`)."""


class HandVoter(Voter):
    """Base of voters that compare the shapes of single hands, as seen in the image.

    Most descriptors are D vectors in the image, as complex numbers ``x + jy`` with real and
    imaginary parts apart, whose squares sum to 1. A query is turned by up to `MOST_TURNED` degrees
    to where it fits best; beyond, the orientation counts, which tells up from down.

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


def describe_vectors(vectors: FloatArray, palm: float) -> FloatArray:
    """Return the descriptor of vectors ``(D, 2)``, ``(2 D,)``: of length 1 / `palm`."""
    parts = vectors.T.ravel()
    return np.asarray(parts / max(palm * float(np.sqrt(parts @ parts)), 1e-12))
