"""Contours: the outer contours of a trajectory image, which four of the paper's voters measure."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import cv2
import numpy as np
import numpy.typing as npt

from app.recognition.features.morphology import close_image

CLOSING_DIAMETER = 28
"""Diameter in pixels of the disc that closes gaps between strokes before contours are taken.

A circle that is not quite closed would have the area of its stroke only. The disc bridges 20
pixels, a tenth of the drawing; on air-drawn digits of other people closing gains 12 points.
"""


BinaryImage: TypeAlias = npt.NDArray[np.uint8]
"""``(height, width)``, 255 on a stroke, 0 elsewhere; x to the right, y down."""


Polygon: TypeAlias = npt.NDArray[np.int32]
"""``(N, 2)`` pixels, x right, y down."""


@dataclass(frozen=True, eq=False)
class Contour:
    """The outer contours of an image's strokes.

    Attributes
    ----------
    contours
        Each a closed polygon of neighbouring pixels, from the leftmost figure to the rightmost
        (by mean x, then mean y).

    """

    contours: tuple[Polygon, ...]

    @classmethod
    def of(cls, image: BinaryImage) -> Contour:
        """Close gaps and follow the outer contours (Suzuki and Abe 1985).

        The cost grows with the area of the image, so crop it to the strokes first.
        """
        height, width = image.shape
        border = CLOSING_DIAMETER // 2 + 1
        row = -(-(width + 2 * border) // 8) * 8
        padded = np.zeros((height + 2 * border, row), dtype=np.uint8)
        padded[border : border + height, border : border + width] = image
        found, _ = cv2.findContours(
            close_image(padded, CLOSING_DIAMETER),
            cv2.RETR_EXTERNAL,
            cv2.CHAIN_APPROX_NONE,
            offset=(-border, -border),
        )
        contours = [np.asarray(contour[:, 0], dtype=np.int32) for contour in found]
        if len(contours) > 1:
            contours.sort(key=lambda contour: tuple(contour.mean(axis=0)))
        return cls(tuple(contours))

    @cached_property
    def area(self) -> float:
        """Square pixels enclosed by the contours, at least one."""
        return max(1.0, float(sum(map(cv2.contourArea, self.contours))))

    @cached_property
    def perimeter(self) -> float:
        """Total length of the contours in pixels, at least one."""
        return max(1.0, float(sum(cv2.arcLength(each, True) for each in self.contours)))

    @cached_property
    def points(self) -> Polygon:
        """``(N, 2)`` points of all contours, one contour after the other."""
        return np.concatenate(self.contours)

    @cached_property
    def hull_area(self) -> float:
        """Square pixels of the convex hull of all contours together, at least one."""
        return max(1.0, float(cv2.contourArea(cv2.convexHull(self.points))))

    @cached_property
    def box(self) -> tuple[float, float]:
        """Width and height in pixels of the upright bounding box, stroke included."""
        _, _, width, height = cv2.boundingRect(self.points)
        return float(width), float(height)
