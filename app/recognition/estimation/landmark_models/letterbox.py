"""Letterbox: fits an image into a model's input without distortion, with bars at the sides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from app.recognition.poses.frame import Image
from app.recognition.poses.sequence import FloatArray

BAR: Final = (114, 114, 114)
"""The grey of the bars, as in the training of YOLO models."""


@dataclass(frozen=True)
class Letterbox:
    """Position of an image in a model's input.

    Attributes
    ----------
    width, height
        Pixels of the input that the image fills, at least one each.
    left, top
        Pixels of the bars before it.
    image_size
        Width and height of the image in pixels.
    input_size
        Width and height of the input in pixels.

    """

    width: int
    height: int
    left: int
    top: int
    image_size: tuple[int, int]
    input_size: tuple[int, int]

    @classmethod
    def fitting(cls, image_size: tuple[int, int], input_size: tuple[int, int]) -> Letterbox:
        """Centre an image in an input, as large as it goes; sizes are width and height."""
        scale = min(room / side for room, side in zip(input_size, image_size, strict=True))
        width, height = (
            min(room, max(1, round(side * scale)))
            for room, side in zip(input_size, image_size, strict=True)
        )
        left, top = (input_size[0] - width) // 2, (input_size[1] - height) // 2
        return cls(width, height, left, top, image_size, input_size)

    def apply(self, image: Image) -> npt.NDArray[np.uint8]:
        """Return the input ``(height, width, 3)`` for an image of `image_size`."""
        resized = cv2.resize(image, (self.width, self.height), interpolation=cv2.INTER_LINEAR)
        below = self.input_size[1] - self.height - self.top
        beside = self.input_size[0] - self.width - self.left
        filled = cv2.copyMakeBorder(
            resized, self.top, below, self.left, beside, cv2.BORDER_CONSTANT, value=BAR
        )
        return np.asarray(filled, dtype=np.uint8)

    def to_image(self, points: npt.NDArray[np.floating]) -> FloatArray:
        """Map ``(..., 2)`` pixels of the input to pixels of the image; (0, 0) is a corner."""
        return np.asarray((points - np.array([self.left, self.top])) / self._scale)

    @property
    def _scale(self) -> FloatArray:
        """Pixels of the input per pixel of the image, across and down: they differ by rounding."""
        filled = np.array([self.width, self.height], dtype=np.float64)
        return np.asarray(filled / np.array(self.image_size))
