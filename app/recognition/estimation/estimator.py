"""Estimator interface: what every pose estimator provides."""

from __future__ import annotations

from typing import Final, Protocol

import numpy as np

from app.recognition.errors import EstimatorError
from app.recognition.poses.frame import FrameLandmarks, Image

LARGEST_SIDE: Final = 16384
"""Largest side of an image in pixels. OpenCV stores positions in 16 bits, and rotated crops need
some room."""


class PoseEstimator(Protocol):
    """Turns the frames of one clip or camera, in order, into landmarks.

    An estimator tracks: it carries state from frame to frame. Call `reset` before another clip.
    """

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        """Find the body and the hands in `image`, taken `time` seconds after any fixed moment."""

    def reset(self) -> None:
        """Reset tracking and smoothing."""

    def close(self) -> None:
        """Release the models; the estimator cannot be used afterwards."""


def check_image(image: Image) -> None:
    """Check that an image is RGB with 8 bits per channel, and at most `LARGEST_SIDE` pixels wide.

    Raises
    ------
    EstimatorError
        When it is not; the message names the shape and type seen.

    """
    if image.ndim != 3 or image.shape[2] != 3 or not image.size or image.dtype != np.uint8:
        raise EstimatorError(
            f"image has shape {image.shape} and type {image.dtype}, "
            f"expected (height, width, 3) of uint8, RGB"
        )
    if max(image.shape) > LARGEST_SIDE:
        raise EstimatorError(
            f"image has shape {image.shape}, expected (height, width, 3) of at most "
            f"{LARGEST_SIDE} pixels a side; scale it down first"
        )
