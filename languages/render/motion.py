"""Motion of the hand by laws of human movement.

Between two resting places the hand moves with minimum jerk (Flash and Hogan 1985); along a curve it
slows down where the curve is tight, by the two-thirds power law (Lacquaniti, Terzuolo and Viviani
1983); held still, it trembles.
"""

from __future__ import annotations

import numpy as np

from languages.render.body import Array

FLATTEST_CURVE = 2.0
"""Curvature in 1/m below which the hand gets no faster; the power law has no limit on a line."""


def minimum_jerk(share: Array | float) -> Array:
    """Map the share of the time to the share of the way; both from 0 to 1, clipped."""
    s = np.clip(np.asarray(share, dtype=float), 0, 1)
    way: Array = s**3 * (10 - 15 * s + 6 * s**2)
    return way


def along_curve(curve: Array, count: int) -> Array:
    """Place a hand on a curve at `count` evenly spaced instants.

    Parameters
    ----------
    curve
        ``(N, 2)`` metres, dense.
    count
        Instants, the first at the curve's beginning, the last at its end.

    Returns
    -------
    ``(count, 2)`` metres: at rest at both ends, in between with the speed of the power law.

    """
    steps = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    speed = (curvature(curve) + FLATTEST_CURVE) ** (-1 / 3)
    effort = np.concatenate([[0], np.cumsum(steps / ((speed[1:] + speed[:-1]) / 2))])
    wanted = minimum_jerk(np.linspace(0, 1, count)) * effort[-1]
    return np.stack([np.interp(wanted, effort, curve[:, axis]) for axis in range(2)], axis=1)


def curvature(curve: Array) -> Array:
    """Give the curvature ``(N,)`` in 1/m at the points of a dense curve ``(N, 2)`` in metres."""
    first = np.gradient(curve, axis=0)
    second = np.gradient(first, axis=0)
    turning = np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    bent: Array = turning / np.maximum(np.linalg.norm(first, axis=1) ** 3, 1e-12)
    return bent


def tremor(random: np.random.Generator, time: Array, amplitude: float) -> Array:
    """Give the displacement ``(T, 3)`` in metres of a hand that is held still.

    A sum of sines between 0.4 and 9 Hz: slow postural sway carries most of it, the physiological
    tremor of 8 to 9 Hz a tenth (Elble and Randall 1978).
    """
    frequencies = np.array([0.4, 0.9, 1.7, 8.5])
    strengths = np.array([1.0, 0.5, 0.25, 0.1])
    return wander(random, time, frequencies, amplitude * strengths)


def wander(random: np.random.Generator, time: Array, frequencies: Array, strengths: Array) -> Array:
    """Sum sines of random phase: ``(T, 3)``, frequencies in Hz, strengths in metres."""
    phases = random.uniform(0, 2 * np.pi, (len(frequencies), 3))
    angle = 2 * np.pi * frequencies[:, None, None] * time[None, :, None] + phases[:, None, :]
    moved: Array = np.einsum("f,ftc->tc", strengths, np.sin(angle))
    return moved
