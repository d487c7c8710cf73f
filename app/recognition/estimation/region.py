"""A square of the image, turned upright for a model: the crop and the way back."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Self

import cv2
import numpy as np
import numpy.typing as npt

from app.recognition.estimation.base import Image
from app.recognition.poses import FloatArray

TINIEST_SIDE: Final = 1.0
"""Pixels. A region smaller than one pixel shows nothing, whatever the model answers to it."""

LARGEST_SIDE: Final = 16384.0
"""Pixels. Positions within a crop are kept in 16 bits, and this leaves room to turn it."""

SUBPIXEL_BITS: Final = 5
"""A crop is sampled at positions rounded to 1/32 pixel.

That is what OpenCV did up to 4.x and what MediaPipe does; from OpenCV 5 on its own functions
sample exactly, which moves landmarks by up to 0.04 of the frame in hard images.
"""

ZERO_BORDER: Final = cv2.BORDER_CONSTANT
"""Black where the region leaves the image: what the detectors were trained on."""

REPLICATED_BORDER: Final = cv2.BORDER_REPLICATE
"""The image's edge drawn out where the region leaves it: what the landmark models expect."""


@dataclass(frozen=True)
class Region:
    """A rotated square region of interest.

    Attributes
    ----------
    x, y
        Its centre in pixels of the image, x right, y down.
    side
        Length of its sides in pixels.
    rotation
        Radians by which the square is turned; positive is clockwise as seen on the screen.

    """

    x: float
    y: float
    side: float
    rotation: float = 0.0

    @classmethod
    def around(cls, image: Image) -> Self:
        """Return the smallest upright square that holds the whole image, centred on it."""
        height, width = image.shape[:2]
        return cls(width / 2, height / 2, float(max(width, height)))

    @classmethod
    def aligned(cls, centre: FloatArray, top: FloatArray, scale: float) -> Self:
        """Return the region centred on one point and turned so that another lies straight above.

        Parameters
        ----------
        centre, top
            ``(2,)`` pixels.
        scale
            Side of the region over twice the distance of the two points.

        """
        reach = math.hypot(top[0] - centre[0], top[1] - centre[1])
        return cls(float(centre[0]), float(centre[1]), 2 * reach * scale, upright(centre, top))

    @property
    def usable(self) -> bool:
        """Tell whether the region is finite and of a size that an image can have."""
        return (
            math.isfinite(self.x + self.y + self.rotation)
            and abs(self.x) < LARGEST_SIDE
            and abs(self.y) < LARGEST_SIDE
            and TINIEST_SIDE <= self.side < LARGEST_SIDE
        )

    def matrix(self, size: int) -> FloatArray:
        """Return the ``(2, 3)`` map from pixels of the `size` x `size` crop to image pixels.

        Crop pixel (0, 0) maps onto the region's corner itself, without half a pixel's shift, as
        in MediaPipe's own converter: its models' outputs are calibrated to that.
        """
        cosine, sine = math.cos(self.rotation), math.sin(self.rotation)
        scale, half = self.side / size, self.side / 2
        return np.array(
            [
                [cosine * scale, -sine * scale, self.x - cosine * half + sine * half],
                [sine * scale, cosine * scale, self.y - sine * half - cosine * half],
            ]
        )

    def crop(
        self, image: Image, size: int, border: int, out: npt.NDArray[np.uint8] | None = None
    ) -> npt.NDArray[np.uint8]:
        """Cut the region, a `usable` one, out of `image`, upright and scaled, bilinearly.

        Parameters
        ----------
        image
            ``(height, width, 3)``, any strides.
        size
            Side of the result in pixels.
        border
            `ZERO_BORDER` or `REPLICATED_BORDER`: what to show beyond the image.
        out
            ``(size, size, 3)`` array to write into, so that no memory is taken per frame.

        """
        whole, fraction = self._positions(size)
        cropped = cv2.remap(image, whole, fraction, cv2.INTER_LINEAR, dst=out, borderMode=border)
        return np.asarray(cropped, dtype=np.uint8)

    def _positions(self, size: int) -> tuple[npt.NDArray[np.int16], npt.NDArray[np.uint16]]:
        """Where in the image each pixel of the crop lies, in OpenCV's fixed-point form.

        Returns
        -------
        ``(size, size, 2)`` whole pixels (x, y), and ``(size, size)`` the fractions of both.
        """
        matrix = self.matrix(size) * (1 << SUBPIXEL_BITS)
        along = np.arange(size)
        x, y = (
            np.rint(np.add.outer(row * along + origin, column * along)).astype(np.int32)
            for column, row, origin in matrix
        )
        whole = np.empty((size, size, 2), np.int16)
        np.right_shift(x, SUBPIXEL_BITS, out=whole[..., 0], casting="unsafe")
        np.right_shift(y, SUBPIXEL_BITS, out=whole[..., 1], casting="unsafe")
        mask = (1 << SUBPIXEL_BITS) - 1
        fraction = ((y & mask) << SUBPIXEL_BITS) | (x & mask)
        return whole, fraction.astype(np.uint16)

    def to_image(self, points: npt.NDArray[np.floating], size: int) -> FloatArray:
        """Map ``(N, 2)`` pixels of the `size` x `size` crop to pixels of the image."""
        matrix = self.matrix(size)
        return np.asarray(points @ matrix[:, :2].T + matrix[:, 2], dtype=np.float64)

    def to_crop(self, points: npt.NDArray[np.floating], size: int) -> FloatArray:
        """Map ``(N, 2)`` pixels of the image to pixels of the `size` x `size` crop."""
        matrix = self.matrix(size)
        offsets = (points - matrix[:, 2]).T
        return np.asarray(np.linalg.solve(matrix[:, :2], offsets).T, dtype=np.float64)

    def overlap(self, other: Region) -> float:
        """Return intersection over union of the two squares, both taken as if upright.

        Like MediaPipe's association of regions: the rotation is left out, for near-square
        regions of one object turn little against each other.
        """
        across = _shared(self.x, self.side, other.x, other.side)
        down = _shared(self.y, self.side, other.y, other.side)
        union = self.side**2 + other.side**2 - across * down
        return across * down / union if union > 0 else 0.0


def upright(base: FloatArray, top: FloatArray) -> float:
    """Return the rotation in [-pi, pi) of a region in which `top` lies straight above `base`."""
    angle = math.pi / 2 - math.atan2(base[1] - top[1], top[0] - base[0])
    return (angle + math.pi) % (2 * math.pi) - math.pi


def _shared(one: float, one_side: float, other: float, other_side: float) -> float:
    """Length two intervals share, each given by its middle and its length."""
    end = min(one + one_side / 2, other + other_side / 2)
    start = max(one - one_side / 2, other - other_side / 2)
    return max(0.0, end - start)
