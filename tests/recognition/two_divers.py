"""Two divers in view: frames of two sample clips beside each other, without a stored clip."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from app.recognition.poses.frame import Image
from app.recognition.recording.video import VideoFrame, VideoInfo, read_frames

STEP = 0.08
"""Seconds between frames: every second one of the sample clips, for speed."""


@dataclass(frozen=True)
class Placed:
    """A clip's diver at a place of the shared picture.

    Attributes
    ----------
    clip
        The file.
    begins
        Seconds at which the diver comes into view, with the clip's beginning.
    scale
        Size of the clip's picture.

    """

    clip: Path
    begins: float = 0.0
    scale: float = 1.0


class Beside:
    """A `FrameSource`: the pictures of clips side by side, as long as the longest one."""

    def __init__(self, *divers: Placed, height: int = 480, width: int = 480) -> None:
        self._divers = divers
        self._height, self._width = height, width
        self.info = VideoInfo(width * len(divers), height, None, None, 0, "none")
        self.warnings: tuple[str, ...] = ()

    def __iter__(self) -> Iterator[VideoFrame]:
        """Go through the frames."""
        columns = [self._column(diver) for diver in self._divers]
        count = max(len(column) for column in columns)
        for index in range(count):
            images = [column[min(index, len(column) - 1)] for column in columns]
            yield VideoFrame(index, index * STEP, np.ascontiguousarray(np.hstack(images)))

    def _column(self, diver: Placed) -> list[Image]:
        with read_frames(diver.clip) as frames:
            images = [
                self._place(frame.image, diver.scale) for frame in frames if not frame.index % 2
            ]
        empty = np.broadcast_to(images[0][:1, :1], images[0].shape)
        return [empty] * round(diver.begins / STEP) + images

    def _place(self, image: Image, scale: float) -> Image:
        """Cut out the middle of a picture, or scale it down with its edge repeated around it."""
        spare = (image.shape[1] - self._width) // 2
        image = image[:, spare : spare + self._width]
        if scale == 1:
            return image
        small = cv2.resize(image, None, None, scale, scale, cv2.INTER_AREA)
        height, width = small.shape[:2]
        left, top = (self._width - width) // 2, (self._height - height) // 2
        right, bottom = self._width - width - left, self._height - height - top
        edge = cv2.copyMakeBorder(small, top, bottom, left, right, cv2.BORDER_REPLICATE)
        return np.asarray(edge, dtype=np.uint8)
