"""One person out of a file of several."""

from __future__ import annotations

import numpy as np

from app.recognition.poses import FloatArray
from app.recognition.subject import boxes_around, prominence


def most_prominent(xy: FloatArray, confidence: FloatArray | None) -> int:
    """Return which of N tracked people stands out most over the whole recording.

    Area of the box around what is seen, times the mean confidence, summed over the frames: who is
    near, well seen and long in view.

    Parameters
    ----------
    xy
        ``(N, T, K, 2)``; NaN: not seen.
    confidence
        ``(N, T, K)`` in [0, 1], or None.

    """
    totals = [
        _prominence(one, None if confidence is None else confidence[index])
        for index, one in enumerate(xy)
    ]
    return int(np.argmax(totals))


def _prominence(xy: FloatArray, confidence: FloatArray | None) -> float:
    seen = np.asarray(np.isfinite(xy).all(axis=2))
    frames = seen.any(axis=1)
    if not frames.any():
        return 0.0
    belief = np.where(seen, 1.0 if confidence is None else confidence, 0.0).mean(axis=1)
    return float(prominence(boxes_around(xy[frames]), belief[frames]).sum())
