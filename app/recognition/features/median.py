"""Median of a few numbers, faster than NumPy's."""

from __future__ import annotations

import numpy as np

from app.recognition.poses.sequence import FloatArray


def median(values: FloatArray) -> float:
    """Return the median of ``(N,)`` finite numbers, N > 0.

    The same value as `numpy.median`, which takes ten times as long for a hundred numbers because
    it handles axes, masks and NaN.
    """
    ordered, half = np.sort(values), len(values) // 2
    return float((ordered[half] + ordered[-half - 1]) / 2)
