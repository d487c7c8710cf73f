"""Voter: magnitudes of Zernike moments."""

from math import factorial

import numpy as np

from app.recognition.poses import FloatArray
from app.recognition.trajectory_image import Drawing
from app.recognition.voters.base import euclidean_distances

DEGREE = 8
"""Highest degree n, 25 moments: the customary order for shapes drawn by hand (Khotanzad and Hong
1990 find 8 to 12 enough for characters); higher ones describe the stroke's edge."""

ORDERS = tuple((n, m) for n in range(DEGREE + 1) for m in range(n % 2, n + 1, 2))
"""Degree n and repetition m of each moment: ``n - m`` is even, negative m mirror positive ones."""


class ZernikeMoments:
    """Zernike moments up to degree 8 (Zernike 1934, Khotanzad and Hong 1990; paper, Sec. IV-D1).

    ``Z = (n + 1) / pi * sum of V*(rho, theta) over the stroke's pixels / their number``, on the
    unit disc around the stroke's centroid that reaches its farthest pixel: free of translation
    and scale. The magnitude is free of rotation.
    """

    name = "zernike"
    unit = "Euclidean distance between the 25 magnitudes"

    def length(self, keypoints: int) -> int:
        """Return the number of descriptors, whatever the number of keypoints."""
        return len(ORDERS)

    def describe(self, drawing: Drawing) -> FloatArray:
        """Return the magnitudes, ``(25,)`` in the order of `ORDERS`."""
        y, x = np.nonzero(drawing.image)
        offsets = np.stack([x - x.mean(), y - y.mean()], axis=1)
        return zernike_magnitudes(offsets / max(1.0, np.linalg.norm(offsets, axis=1).max()))

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return Euclidean distances, ``(G,)``."""
        return euclidean_distances(query, references)


def zernike_magnitudes(points: FloatArray) -> FloatArray:
    """Return ``|Z|``, ``(25,)``, of equally weighted points ``(N, 2)`` in the unit disc."""
    disc = points[:, 0] + 1j * points[:, 1]
    radius = np.abs(disc)
    # Pixels lie exactly on the centroid only by chance; there the angle does not matter.
    angle = np.divide(disc, radius, out=np.ones_like(disc), where=radius > 0)
    radius_powers = radius ** np.arange(DEGREE + 1)[:, None]
    angle_powers = angle.conj() ** np.arange(DEGREE + 1)[:, None]
    radial = _RADIAL_COEFFICIENTS @ radius_powers
    repetitions = [m for _, m in ORDERS]
    means = (radial * angle_powers[repetitions]).mean(axis=1)
    degrees = np.array([n for n, _ in ORDERS])
    return np.asarray((degrees + 1) / np.pi * np.abs(means), dtype=np.float64)


def _radial_coefficients() -> FloatArray:
    """Return ``(25, DEGREE + 1)``: the factor of each power of rho in the radial polynomials."""
    table = np.zeros((len(ORDERS), DEGREE + 1))
    for row, (n, m) in enumerate(ORDERS):
        for s in range((n - m) // 2 + 1):
            table[row, n - 2 * s] = (
                (-1) ** s
                * factorial(n - s)
                / (factorial(s) * factorial((n + m) // 2 - s) * factorial((n - m) // 2 - s))
            )
    return table


_RADIAL_COEFFICIENTS = _radial_coefficients()
