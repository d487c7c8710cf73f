"""What every pose estimator gives, whatever runs behind it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, Protocol

import numpy as np
import numpy.typing as npt

from app.recognition.errors import EstimatorError
from app.recognition.poses import FloatArray

Image = npt.NDArray[np.uint8]
"""``(height, width, 3)`` RGB, upright, y down."""

LARGEST_SIDE: Final = 16384
"""Pixels. OpenCV keeps positions in an image in 16 bits, and this leaves room to turn a crop."""

Side = Literal["left", "right"]
"""The person's own left or right."""

SIDES: Final[tuple[Side, ...]] = ("left", "right")


@dataclass(frozen=True, eq=False)
class Body:
    """One person's pose in one frame.

    Attributes
    ----------
    xy
        ``(33, 2)`` pixels, x right, y down, in the order of `POSE_LANDMARKS`; may lie outside the
        image. NaN: not seen, or not among the landmarks that the estimator's model has.
    visibility
        ``(33,)`` in [0, 1]: the model's belief that the landmark is in view and not hidden.
    score
        The model's belief in [0, 1] that there is a person at all.

    """

    xy: FloatArray
    visibility: FloatArray
    score: float


@dataclass(frozen=True, eq=False)
class Hand:
    """One hand in one frame.

    Attributes
    ----------
    xy
        ``(21, 2)`` pixels, x right, y down, in the order of `HAND_LANDMARKS`.
    side
        The person's left or right hand, as the model sees it.
    score
        The model's belief in [0, 1] that there is a hand at all.

    """

    xy: FloatArray
    side: Side
    score: float

    @property
    def size(self) -> float:
        """Diagonal of the landmarks' bounding box in pixels."""
        return float(np.linalg.norm(self.xy.max(axis=0) - self.xy.min(axis=0)))


@dataclass(frozen=True, eq=False)
class FrameLandmarks:
    """All that was found in one frame: at most one body, and up to two hands, larger first."""

    body: Body | None
    hands: tuple[Hand, ...]


class PoseEstimator(Protocol):
    """Turns the frames of one clip or camera, in order, into landmarks.

    An estimator tracks: it carries state from frame to frame. Call `reset` before another clip.
    """

    def estimate(self, image: Image, time: float) -> FrameLandmarks:
        """Find the body and the hands in `image`, taken `time` seconds after any fixed moment."""
        ...

    def reset(self) -> None:
        """Forget what was tracked and smoothed so far."""
        ...

    def close(self) -> None:
        """Release the models; the estimator cannot be used afterwards."""
        ...


def check_image(image: Image) -> None:
    """Refuse what is no RGB image of 8 bits per channel, or larger than `LARGEST_SIDE`.

    Raises
    ------
    EstimatorError
        Naming the shape and type seen.

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
