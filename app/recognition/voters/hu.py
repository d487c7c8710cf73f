"""Voter: Hu's seven moment invariants."""

import cv2
import numpy as np

from app.recognition.poses import FloatArray
from app.recognition.trajectory_image import Drawing
from app.recognition.voters.base import euclidean_distances

FLOOR = 1e-2
"""Magnitude below which an invariant counts as zero.

Invariants of strokes lie between 1 and 1e-10. Those that are zero in theory, for symmetric
figures, come out anywhere up to this when a person draws them, and on a plain logarithm their
noise would outweigh the invariants that mean something.
"""


ORDERS = ((2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))
"""Powers of x and y in the moments that the invariants are made of."""


class HuMoments:
    """Hu's invariants of translation, scale and rotation (Hu 1962; paper, Sec. IV-D1).

    From the normalised central moments of the stroke's pixels, on a logarithmic scale that keeps
    the sign: ``sign(h) log10(1 + |h| / FLOOR)``, for they span ten decades and unscaled the
    first would outvote the other six.
    """

    name = "hu"
    unit = "Euclidean distance between the seven invariants, each in decades"

    def length(self, keypoints: int) -> int:
        """Return the number of descriptors, whatever the number of keypoints."""
        return 7

    def describe(self, drawing: Drawing) -> FloatArray:
        """Return the seven invariants, ``(7,)``."""
        moments = {f"nu{p}{q}": drawing.moments.central(p, q) for p, q in ORDERS}
        invariants = np.asarray(cv2.HuMoments(moments), dtype=np.float64).ravel()
        return np.asarray(np.sign(invariants) * np.log10(1 + np.abs(invariants) / FLOOR))

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return Euclidean distances, ``(G,)``."""
        return euclidean_distances(query, references)
