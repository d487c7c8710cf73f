"""Shape voters: compare trajectory images (paper, Sec. IV-D).

`aspect_ratio`, `solidity`, `circularity` and `path_complexity` compare one proportion, `fourier`
the Fourier descriptors of the contour, `hu` Hu's seven moment invariants, and `zernike` the
magnitudes of Zernike moments.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from itertools import accumulate
from math import comb, factorial, log2, pi
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from app.recognition.features.contour import Polygon
from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.voter import Voter, absolute_differences, euclidean_distances

DESCRIPTOR_DIGITS = 6
"""Decimals of a descriptor: files stay small, and a saved language gives the same results."""


class ShapeVoter(Voter):
    """Base of voters that compare a query's drawing with each gesture's.

    They compare descriptors only, so that each drawing is described once.
    """

    @abstractmethod
    def length(self, keypoints: int) -> int:
        """Return D, the length of the descriptor for a number of salient landmarks."""

    @abstractmethod
    def describe(self, drawing: Drawing) -> FloatArray:
        """Return the descriptor of a drawing that has a stroke: ``(D,)`` finite numbers."""


class ProportionVoter(ShapeVoter):
    """Base of voters with one number as descriptor, compared by difference (paper, Sec. IV-D2)."""

    def length(self, keypoints: int) -> int:
        """Return the length of the descriptor, the same for any number of landmarks."""
        return 1

    def describe(self, drawing: Drawing) -> FloatArray:
        """Return the proportion, ``(1,)``."""
        return np.array([self.measure(drawing)])

    @abstractmethod
    def measure(self, drawing: Drawing) -> float:
        """Return the proportion of a drawing that has a stroke."""

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return absolute differences, ``(G,)``."""
        return absolute_differences(query, references)


class AspectRatio(ProportionVoter):
    """Difference of ``log2(width / height)`` of the box around the strokes.

    The paper has no logarithm; with it, twice as wide and twice as high are equally far from
    square.
    """

    name = "aspect_ratio"
    unit = "doublings of width over height"

    def measure(self, drawing: Drawing) -> float:
        """Return 0 for a square box, > 0 for a wide one, < 0 for a high one."""
        width, height = drawing.contour.box
        return log2(width / height)


class Solidity(ProportionVoter):
    """Area of the contour over the area of its convex hull: 1 for a disc, small for a V."""

    name = "solidity"
    unit = "share of the convex hull's area"

    def measure(self, drawing: Drawing) -> float:
        """Return the share, in (0, 1]."""
        return drawing.contour.area / drawing.contour.hull_area


class Circularity(ProportionVoter):
    """``4 pi a / p^2`` of the contour's area a and perimeter p: 1 for a disc, 0.79 for a square."""

    name = "circularity"
    unit = "share of the area of a disc with the same perimeter"

    def measure(self, drawing: Drawing) -> float:
        """Return the circularity, in (0, 1]."""
        return 4 * pi * drawing.contour.area / drawing.contour.perimeter**2


class PathComplexity(ProportionVoter):
    """Length of the contour over the perimeter of its bounding box: high for a zigzag."""

    name = "path_complexity"
    unit = "perimeters of the bounding box"

    def measure(self, drawing: Drawing) -> float:
        """Return the complexity, about 0.8 for a circle, 1 for a square and more for a zigzag."""
        return drawing.contour.perimeter / (2 * sum(drawing.contour.box))


def describe_drawing(drawing: Drawing, voters: Sequence[ShapeVoter]) -> dict[str, FloatArray]:
    """Compute the descriptors of a drawing for several voters.

    Returns
    -------
    The rounded descriptors by the voters' names; empty for an empty drawing.

    """
    if drawing.empty:
        return {}
    described = [voter.describe(drawing) for voter in voters]
    # Adding 0 turns -0.0 into 0.0, which files do not distinguish.
    rounded = np.round(np.concatenate([*described, []]), DESCRIPTOR_DIGITS) + 0.0
    ends = accumulate(len(each) for each in described)
    return {
        voter.name: rounded[end - len(each) : end]
        for voter, each, end in zip(voters, described, ends, strict=True)
    }


ComplexArray: TypeAlias = npt.NDArray[np.complex128]

HARMONICS = 10
"""Harmonics kept on either side of zero (paper: "low-frequency coefficients").

The tenth has ten waves around the contour, details of a tenth of the drawing; finer ones are
jitter.
"""

SAMPLES = 256
"""Points at equal steps along the contour: far more than the highest harmonic needs."""

START_POINTS = 128
"""Start points tried when two contours are compared: a step of 1/128 turns the highest harmonic
by less than a twelfth of its period."""

_KEPT = np.concatenate([np.arange(1, HARMONICS + 1), np.arange(-HARMONICS, 0)])


_TURNS = 2 * np.pi / START_POINTS * np.outer(_KEPT, np.arange(START_POINTS))
_BEGUN = np.concatenate([np.cos(_TURNS), -np.sin(_TURNS)])
"""``(40, START_POINTS)``: rotation of the real and imaginary part of each harmonic's product with
another contour's, for each start point."""


class FourierDescriptors(ShapeVoter):
    """Low harmonics of the contour as a complex signal (Granlund 1972; paper, Sec. IV-D1).

    The outer contours, from left to right, are sampled as one closed curve ``z = x + jy`` in 256
    equal steps and transformed. Leaving out harmonic 0 makes them independent of translation,
    division by their norm of scale. The distance of two contours is the least over all start
    points, computed for all references at once by cross-correlation. Rotation counts, so that 6
    and 9 differ.
    """

    name = "fourier"
    unit = "Euclidean distance between outlines of norm 1 at their best common start point"

    def length(self, keypoints: int) -> int:
        """Return the length of the descriptor, the same for any number of landmarks."""
        return 2 * len(_KEPT)

    def describe(self, drawing: Drawing) -> FloatArray:
        """Return real, then imaginary parts of harmonics 1...10, -10...-1: ``(40,)``."""
        spectrum = np.fft.fft(_equal_steps(drawing.contour.points))[_KEPT]
        parts = np.concatenate([spectrum.real, spectrum.imag])
        return np.asarray(parts / max(math.sqrt(parts @ parts), 1e-12))  # a single pixel has none

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return the distances at the best start points, ``(G,)`` between 0 and 2."""
        half = len(query) // 2
        (real, imaginary), (reals, imaginaries) = (
            (both[..., :half], both[..., half:]) for both in (query, references)
        )
        products = np.concatenate(
            [reals * real + imaginaries * imaginary, imaginaries * real - reals * imaginary], axis=1
        )
        correlation = (products @ _BEGUN).max(axis=1)
        energy = query @ query + np.vecdot(references, references)
        # A difference of nearly equal sums: rounding errors are set to 0.
        squares = energy - 2 * correlation
        squares[squares < 1e-12 * energy] = 0.0
        return np.asarray(np.sqrt(squares), dtype=np.float64)


def _equal_steps(points: Polygon) -> ComplexArray:
    """Resample a closed polygon ``(N, 2)`` to `SAMPLES` complex numbers x + jy."""
    closed = np.empty(len(points) + 1, dtype=np.complex128)
    closed.real[:-1], closed.imag[:-1] = points.T
    closed[-1] = closed[0]
    travelled = np.zeros(len(closed))
    np.cumsum(np.abs(closed[1:] - closed[:-1]), out=travelled[1:])
    steps = travelled[-1] / SAMPLES * np.arange(SAMPLES)
    return np.asarray(np.interp(steps, travelled, closed), dtype=np.complex128)


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
