"""Skeleton image: draws a skeleton on black, for clips that have landmarks and no video."""

from __future__ import annotations

import cv2
import numpy as np

from app.recognition.poses.frame import Image
from app.recognition.poses.landmarks import POSE_LANDMARKS, SKELETON
from app.recognition.poses.sequence import FloatArray

BONE = (208, 214, 222)
JOINT = (90, 160, 255)
"""RGB, light on black; the studio draws its own colours over the picture."""

THICKNESS = 1 / 160
"""Thickness of a bone, in heights of the picture: three pixels of 480, visible on a thumbnail."""

_SUBPIXEL = 4
"""Fractional bits of coordinates in OpenCV's drawing, so that movement is smooth."""

_FARTHEST = 2.0
"""Farthest point drawn, in picture sizes beyond the edge: OpenCV counts in 32 bits."""


def skeleton_picture(xy: FloatArray, size: tuple[int, int]) -> Image:
    """Draw one frame's body on black.

    Parameters
    ----------
    xy
        ``(33, 2)`` pixels of `POSE_LANDMARKS`, NaN where not seen.
    size
        Width and height in pixels.

    Returns
    -------
    ``(height, width, 3)`` RGB.

    """
    width, height = size
    picture = np.zeros((height, width, 3), dtype=np.uint8)
    thickness = max(2, round(height * THICKNESS))
    limit = _FARTHEST * max(size)
    # The comparison is False for NaN.
    seen = np.asarray((np.abs(xy) < limit).all(axis=1))
    points = np.rint(np.nan_to_num(np.clip(xy, -limit, limit)) * 2**_SUBPIXEL).astype(int)
    for one, other in SKELETON:
        first, second = POSE_LANDMARKS.index(one), POSE_LANDMARKS.index(other)
        if seen[first] and seen[second]:
            ends = tuple(points[first].tolist()), tuple(points[second].tolist())
            cv2.line(picture, *ends, BONE, thickness, cv2.LINE_AA, _SUBPIXEL)
    for point in points[seen].tolist():
        radius = thickness << _SUBPIXEL
        cv2.circle(picture, tuple(point), radius, JOINT, cv2.FILLED, cv2.LINE_AA, _SUBPIXEL)
    return picture
