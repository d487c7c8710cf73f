"""Poster and timeline thumbnails of a clip, as JPEG."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import cv2
import numpy as np

from app.api.workers.worker_messages import MOST_PICTURE_BYTES
from app.recognition.errors import VideoError
from app.recognition.poses.frame import Image
from app.recognition.recording import video

POSTER_SECONDS = 1.0
"""Second of the clip from which its still picture is taken: recordings often begin black or
shaking."""

POSTER_WIDTH = 320
"""Pixels; a card of the page at twice the usual screen density."""

THUMBNAIL_HEIGHT = 72
"""Pixels; the timeline's track at twice the usual screen density."""

FEWEST_THUMBNAILS = 32
"""Fewest thumbnails of a long clip: a timeline 1400 wide shows about thirty of 4:3. At most twice
as many are kept."""


def write_poster(clip: Path, poster: Path) -> None:
    """Write a small JPEG of the frame at `POSTER_SECONDS`, or of the last one before."""
    wanted = Poster(poster)
    with video.read_frames(clip) as frames:
        for frame in frames:
            if wanted.add(frame.time, frame.image):
                return
    wanted.write()


def first_picture(clip: Path) -> bytes | None:
    """Return a small JPEG of a video's first frame, for a clip whose job has not begun.

    None for what cannot be decoded, or is too large for a message.
    """
    with suppress(VideoError), video.read_frames(clip) as frames:
        image = next(frames).image
        height, width = image.shape[:2]
        scale = min(1.0, POSTER_WIDTH / max(height, width))
        picture = _jpeg(_resize(image, round(width * scale), round(height * scale)), quality=75)
        return picture if len(picture) <= MOST_PICTURE_BYTES else None
    return None


class Poster:
    """Keeps the frame at `POSTER_SECONDS`, or the last one before, as a small JPEG.

    Parameters
    ----------
    path
        Where to write it.

    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._image: Image | None = None
        self._written = False

    def add(self, time: float, image: Image) -> bool:
        """Take the frame at `time` seconds; return whether the picture is written by now."""
        if not self._written:
            self._image = image
            if time >= POSTER_SECONDS:
                self.write()
        return self._written

    def write(self) -> None:
        """Write the last frame taken, unless it is done or there is none."""
        if self._written or self._image is None:
            return
        height, width = self._image.shape[:2]
        size = (POSTER_WIDTH, round(height * POSTER_WIDTH / width))
        _write(_resize(self._image, *size), self._path)
        self._written, self._image = True, None


class Thumbnails:
    """Keeps small pictures at even distances, for a clip of unknown length.

    It keeps every frame at first; whenever there are too many, every other one is dropped.
    """

    def __init__(self) -> None:
        self._stride = 1
        self._images: list[Image] = []

    def add(self, index: int, image: Image) -> None:
        """Take frame number `index`; frames come in order, none left out."""
        if index % self._stride:
            return
        height, width = image.shape[:2]
        small = _resize(image, round(width * THUMBNAIL_HEIGHT / height), THUMBNAIL_HEIGHT)
        self._images.append(small)
        if len(self._images) >= 2 * FEWEST_THUMBNAILS:
            self._images = self._images[::2]
            self._stride *= 2

    def write(self, path: Path) -> None:
        """Write all thumbnails side by side as one JPEG; do nothing if there are none."""
        if self._images:
            _write(np.concatenate(self._images, axis=1), path)


def thumbnails_in(frames: int) -> int:
    """Return how many thumbnails a clip of so many frames has."""
    stride = 1
    while -(-frames // stride) >= 2 * FEWEST_THUMBNAILS:
        stride *= 2
    return -(-frames // stride)


def _resize(image: Image, width: int, height: int) -> Image:
    size = (max(1, width), max(1, height))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _write(image: Image, path: Path) -> None:
    partial = path.with_suffix(".part")
    partial.write_bytes(_jpeg(image))
    partial.replace(path)


def _jpeg(image: Image, quality: int = 95) -> bytes:
    bgr = cv2.cvtColor(image, cv2.COLOR_RGB2BGR)
    _, encoded = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return encoded.tobytes()
