"""Prominence of a person among several: size and confidence over time."""

from __future__ import annotations

import numpy as np

from app.recognition.estimation.person_tracker import find_boxes, measure_prominence
from app.recognition.poses.sequence import FloatArray


def prominence_over(xy: FloatArray, confidence: FloatArray | None = None) -> float:
    """Return the prominence of one tracked person over T frames.

    It is the area of the box around the seen keypoints, times the mean confidence, summed over the
    frames: highest for a person who is near, well seen and long in view.

    Parameters
    ----------
    xy
        ``(T, K, 2)``; NaN: not seen.
    confidence
        ``(T, K)`` in [0, 1], or None.

    """
    seen = np.asarray(np.isfinite(xy).all(axis=2))
    frames = seen.any(axis=1)
    if not frames.any():
        return 0.0
    belief = np.where(seen, 1.0 if confidence is None else confidence, 0.0).mean(axis=1)
    return float(measure_prominence(find_boxes(xy[frames]), belief[frames]).sum())
