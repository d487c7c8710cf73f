"""Voter `hu`: Hu's seven moment invariants."""

import numpy as np

from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.shape_voters import ShapeVoter
from app.recognition.voters.voter import euclidean_distances

FLOOR = 1e-2
"""Magnitude below which an invariant counts as zero.

Invariants of strokes lie between 1 and 1e-10. Those that are zero in theory, for symmetric
figures, reach this value when people draw them; on a plain logarithm their noise would dominate.
"""


class HuMoments(ShapeVoter):
    """Hu's invariants of translation, scale and rotation (Hu 1962; paper, Sec. IV-D1).

    Computed from the normalised central moments of the stroke's pixels, on a signed logarithmic
    scale, ``sign(h) log10(1 + |h| / FLOOR)``: they span ten decades, and unscaled the first would
    dominate the other six.
    """

    name = "hu"
    unit = "Euclidean distance between the seven invariants, each in decades"

    def length(self, keypoints: int) -> int:
        """Return the length of the descriptor, the same for any number of landmarks."""
        return 7

    def describe(self, drawing: Drawing) -> FloatArray:
        """Return the seven invariants, ``(7,)``."""
        nu = drawing.moments.central
        # Hu's sums are products of complex moments, whose phase a rotation turns (Flusser 2000).
        spread, ellipse = nu(2, 0) + nu(0, 2), complex(nu(2, 0) - nu(0, 2), 2 * nu(1, 1))
        lean = complex(nu(3, 0) + nu(1, 2), nu(2, 1) + nu(0, 3))
        triangle = complex(nu(3, 0) - 3 * nu(1, 2), 3 * nu(2, 1) - nu(0, 3))
        against = lean.conjugate()
        turned = triangle * against**3
        sizes = (spread, abs(ellipse) ** 2, abs(triangle) ** 2, abs(lean) ** 2)
        invariants = np.array([*sizes, turned.real, (ellipse * against**2).real, turned.imag])
        return np.asarray(np.sign(invariants) * np.log10(1 + np.abs(invariants) / FLOOR))

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return Euclidean distances, ``(G,)``."""
        return euclidean_distances(query, references)
