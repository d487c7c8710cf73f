"""Voter `zernike`: magnitudes of Zernike moments."""

from math import comb, factorial

import numpy as np
import numpy.typing as npt

from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.shape_voters import ShapeVoter
from app.recognition.voters.voter import euclidean_distances

DEGREE = 8
"""Highest degree n, 25 moments: the usual order for handwritten shapes (Khotanzad and Hong 1990: 8
to 12 for characters); higher degrees describe the stroke's edge."""

ORDERS = tuple((n, m) for n in range(DEGREE + 1) for m in range(n % 2, n + 1, 2))
"""Degree n and repetition m of each moment: ``n - m`` is even, negative m mirror positive ones."""


class ZernikeMoments(ShapeVoter):
    """Zernike moments up to degree 8 (Zernike 1934, Khotanzad and Hong 1990; paper, Sec. IV-D1).

    ``Z = (n + 1) / pi * sum of V*(rho, theta) over the stroke's pixels / their number``, on the
    unit disc around the stroke's centroid that reaches its farthest pixel: independent of
    translation and scale. The magnitude is independent of rotation.
    """

    name = "zernike"
    unit = "Euclidean distance between the 25 magnitudes"

    def length(self, keypoints: int) -> int:
        """Return the length of the descriptor, the same for any number of landmarks."""
        return len(ORDERS)

    def describe(self, drawing: Drawing) -> FloatArray:
        """Return the magnitudes, ``(25,)`` in the order of `ORDERS`."""
        return zernike_magnitudes(drawing.moments.means)

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return Euclidean distances, ``(G,)``."""
        return euclidean_distances(query, references)


def zernike_magnitudes(means: FloatArray) -> FloatArray:
    """Return ``|Z|``, ``(25,)``, from the moments in the unit disc.

    Zernike's polynomials are sums of products of powers of x and y, so their means are the same
    sums of the moments.

    Parameters
    ----------
    means
        ``(DEGREE + 1, DEGREE + 1)``: the mean of ``x^p y^q``.

    """
    return np.asarray(_FACTORS * np.abs(_OF_POWERS @ means.ravel()), dtype=np.float64)


def _coefficients_of_powers() -> npt.NDArray[np.complex128]:
    """Return ``(25, (DEGREE + 1)^2)``: the factor of each ``x^p y^q`` in each ``V*``.

    ``V* = sum over s of c_s rho^(n - 2s - m) (x - jy)^m``, and ``rho^2 = x^2 + y^2``.
    """
    table = np.zeros((len(ORDERS), DEGREE + 1, DEGREE + 1), dtype=np.complex128)
    for row, (n, m) in enumerate(ORDERS):
        for s in range((n - m) // 2 + 1):
            radial = (
                (-1) ** s
                * factorial(n - s)
                / (factorial(s) * factorial((n + m) // 2 - s) * factorial((n - m) // 2 - s))
            )
            half = (n - m) // 2 - s
            for a in range(half + 1):
                for b in range(m + 1):
                    factor = radial * comb(half, a) * comb(m, b) * (-1j) ** b
                    table[row, 2 * (half - a) + m - b, 2 * a + b] += factor
    return table.reshape(len(ORDERS), -1)


_OF_POWERS = _coefficients_of_powers()
_FACTORS = (np.array([n for n, _ in ORDERS]) + 1) / np.pi
