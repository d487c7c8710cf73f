"""A flat hand as 21 points, to place and turn."""

from __future__ import annotations

import math

import numpy as np

from app.recognition.poses.sequence import FloatArray


def flat_hand(*, size: float = 100.0) -> FloatArray:
    """Return an open hand, fingers up, wrist at the origin, from wrist to middle tip `size`."""
    fingers = [
        [(-0.25 + 0.17 * finger, -0.5 - 0.16 * joint) for joint in range(4)] for finger in range(4)
    ]
    thumb = [(-0.2 - 0.06 * joint, -0.15 - 0.1 * joint) for joint in range(4)]
    points = [(0.0, 0.0), *thumb, *(point for finger in fingers for point in finger)]
    return np.multiply(points, size, dtype=np.float64)


def turned(points: FloatArray, angle: float) -> FloatArray:
    """Turn points clockwise as seen on the screen."""
    cosine, sine = math.cos(angle), math.sin(angle)
    rotation: FloatArray = np.array([[cosine, sine], [-sine, cosine]])
    return np.asarray(points @ rotation, dtype=np.float64)
