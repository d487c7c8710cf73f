"""Image moments of a drawing's strokes, shared by all voters that use them.

Strokes are runs of pixels, a few in each row of the image. The sum of a power of x over a run is
the difference of two entries of a table, so that only the ends of runs are read.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import FloatArray

HIGHEST_POWER = 8
"""Highest power of x and of y, the highest degree that a voter needs."""


@dataclass(frozen=True, eq=False)
class StrokeMoments:
    """Moments of the pixels of strokes about their centroid.

    Attributes
    ----------
    count
        Number of pixels.
    radius
        Distance in pixels of the farthest of them from the centroid, at least 1.
    means
        ``(HIGHEST_POWER + 1, HIGHEST_POWER + 1)``: the mean of ``x^p y^q``, x to the right and y
        down from the centroid, in units of `radius`.

    """

    count: int
    radius: float
    means: FloatArray

    @classmethod
    def of(cls, image: npt.NDArray[np.uint8]) -> StrokeMoments:
        """Measure an image ``(height, width)``, whose strokes are not 0.

        The cost grows with the area of the image, so crop it to the strokes first.
        """
        height, width = image.shape
        # A column of background on the right ends every run within its row.
        pixels = np.zeros(1 + height * (width + 1), dtype=np.uint8)
        pixels[1:].reshape(height, width + 1)[:, :width] = image
        changes = (pixels[1:] != pixels[:-1]).nonzero()[0]
        begins, ends = changes[::2], changes[1::2]
        row = begins // (width + 1)
        first_of_row = row * (width + 1)
        start, stop = begins - first_of_row, ends - first_of_row
        lengths = stop - start
        count = int(lengths.sum())
        centre_x = float(lengths @ (start + stop - 1)) / (2 * count)
        centre_y = float(lengths @ row) / count
        across, down = np.maximum(centre_x - start, stop - 1 - centre_x), row - centre_y
        radius = max(1.0, float((across * across + down * down).max()) ** 0.5)
        x, y = (np.arange(width) - centre_x) / radius, (np.arange(height) - centre_y) / radius
        powers = _powers(np.concatenate([x, y]))
        sums = np.zeros((HIGHEST_POWER + 1, width + 1))
        np.cumsum(powers[:, :width], axis=1, out=sums[:, 1:])
        of_runs = sums.take(stop, axis=1) - sums.take(start, axis=1)
        return cls(count, radius, of_runs @ powers.take(width + row, axis=1).T / count)

    def central(self, p: int, q: int) -> float:
        """Return Hu's normalised central moment, ``mu_pq / mu_00^(1 + (p + q) / 2)``."""
        return float(self.means[p, q] * (self.radius / self.count**0.5) ** (p + q))


def _powers(values: FloatArray) -> FloatArray:
    """Return the powers 0 to `HIGHEST_POWER` of ``(N,)`` values, one a row."""
    powers = np.ones((HIGHEST_POWER + 1, len(values)))
    for exponent in range(1, HIGHEST_POWER + 1):
        np.multiply(powers[exponent - 1], values, out=powers[exponent])
    return powers
