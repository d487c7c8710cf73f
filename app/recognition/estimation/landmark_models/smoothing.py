"""Smoothing filters: remove the jitter of landmarks over time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from app.recognition.poses.sequence import FloatArray


@dataclass
class _Memory:
    """State of the one-euro filter between two calls."""

    time: float
    raw: FloatArray
    filtered: FloatArray
    speed: FloatArray


class OneEuroFilter:
    """The one-euro filter (Casiez, Roussel, Vogel 2012): a low pass that opens with speed.

    Each value is smoothed with a cutoff of ``minimum_cutoff + beta * |speed|``: strongly at
    rest, where jitter is seen, hardly in motion, where lag is seen. The speed itself is the
    low-passed difference of the raw values. Every element of the array is its own signal.

    Parameters
    ----------
    minimum_cutoff
        Hz, the cutoff at rest.
    beta
        Growth of the cutoff in Hz per unit of scaled speed (``values * scale`` per second).
    speed_cutoff
        Hz, the cutoff of the speed's own low pass. One, as in the paper.

    """

    def __init__(self, minimum_cutoff: float, beta: float, speed_cutoff: float = 1.0) -> None:
        self._minimum_cutoff = minimum_cutoff
        self._beta = beta
        self._speed_cutoff = speed_cutoff
        self._memory: _Memory | None = None

    def apply(self, values: FloatArray, time: float, scale: float = 1.0) -> FloatArray:
        """Smooth the next values of the signal.

        Parameters
        ----------
        values
            Array of any shape, the same in every call.
        time
            Seconds. A time not after the previous one restarts the filter, since there is no
            speed.
        scale
            Factor on speeds before `beta`: one over the object's size makes the filter independent
            of the distance. Filtering ``k * values`` with ``scale / k`` gives ``k`` times the
            result.

        Returns
        -------
        The filtered values, a new array.

        """
        memory = self._memory
        if memory is None or not time > memory.time:
            self._memory = _Memory(time, values.copy(), values.copy(), np.zeros_like(values))
            return values.copy()
        step = time - memory.time
        speed = (values - memory.raw) * (scale / step)
        memory.speed += _weight(self._speed_cutoff, step) * (speed - memory.speed)
        cutoff = self._minimum_cutoff + self._beta * np.abs(memory.speed)
        weight = 1 / (1 + 1 / (2 * math.pi * step * cutoff))
        filtered = memory.filtered + weight * (values - memory.filtered)
        memory.time, memory.raw, memory.filtered = time, values.copy(), filtered
        return filtered.copy()


class ExponentialFilter:
    """Exponential smoothing: each result is `weight` of the new and the rest of the old value."""

    def __init__(self, weight: float) -> None:
        self._weight = weight
        self._filtered: FloatArray | None = None

    def apply(self, values: FloatArray) -> FloatArray:
        """Smooth the next values (any shape, the same in every call); return a new array."""
        old = values if self._filtered is None else self._filtered
        self._filtered = old + self._weight * (values - old)
        return self._filtered.copy()


def _weight(cutoff: float, step: float) -> float:
    """Return the weight of a new value in a first-order low pass of `cutoff` Hz, `step` seconds."""
    return 1 / (1 + 1 / (2 * math.pi * cutoff * step))
