"""Voter `fourier`: Fourier descriptors of the contour."""

import math
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from app.recognition.features.contour import Polygon
from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.shape_voters import ShapeVoter

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
