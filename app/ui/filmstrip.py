"""Filmstrip: keeps the frames of a clip in memory as small JPEG images."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable
from pathlib import Path
from threading import Event, Lock, Thread

import cv2
import numpy as np

from app.recognition.errors import VideoError
from app.recognition.poses.frame import Image
from app.recognition.recording.video import read_frames
from app.ui.charts import encode_jpeg, shrink

MAX_WIDTH = 640
"""Pixels. Larger pictures reduce the frame rate of playback."""

MAX_FRAMES = 1800
"""Most frames kept: a minute at 30 a second; longer ranges keep every n-th frame."""

JPEG_QUALITY = 82
"""Below 80, compression artefacts surround a bright diver on dark water."""


class Filmstrip:
    """Background decoder of a range of a clip; returns the picture nearest to a given frame.

    Parameters
    ----------
    video
        The clip.
    first, last
        Frame indices of the range, both included, counted from 0 over all decoded frames.
    on_frame
        Called from the decoding thread with the index of every frame that was added.

    """

    def __init__(
        self, video: Path, first: int, last: int, on_frame: Callable[[int], None] | None = None
    ) -> None:
        self._video = video
        self._first, self._last = first, last
        self._stride = max(1, -(-(last - first + 1) // MAX_FRAMES))
        self._on_frame = on_frame
        self._indices: list[int] = []
        self._encoded: list[bytes] = []
        self._lock = Lock()
        self._stop = Event()
        self._complete = Event()
        self._thread = Thread(target=self._decode, name="filmstrip", daemon=True)
        self.error: str | None = None

    def start(self) -> None:
        """Start decoding."""
        self._thread.start()

    def close(self) -> None:
        """Stop decoding and wait for the thread to end."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def wait(self, timeout: float) -> bool:
        """Wait until every frame is decoded; False after `timeout` seconds."""
        return self._complete.wait(timeout)

    def __len__(self) -> int:
        """Count the frames decoded so far."""
        return len(self._indices)

    def kept(self, frame: int) -> int:
        """Return the index nearest to `frame` among the frames that will be kept."""
        kept = (self._last - self._first) // self._stride
        below = min(max((frame - self._first) // self._stride, 0), kept)
        above = min(below + 1, kept)
        lower, upper = (self._first + step * self._stride for step in (below, above))
        return lower if abs(frame - lower) <= abs(upper - frame) else upper

    def nearest(self, frame: int) -> tuple[int, Image] | None:
        """Return index and image ``(H, W, 3)`` RGB of the decoded frame nearest to `frame`.

        None while nothing is decoded.
        """
        with self._lock:
            if not self._indices:
                return None
            at = bisect_left(self._indices, frame)
            candidates = [i for i in (at - 1, at) if 0 <= i < len(self._indices)]
            best = min(candidates, key=lambda i: abs(self._indices[i] - frame))
            index, encoded = self._indices[best], self._encoded[best]
        pixels = cv2.imdecode(np.frombuffer(encoded, np.uint8), cv2.IMREAD_COLOR_RGB)
        return index, np.asarray(pixels, dtype=np.uint8)

    def _decode(self) -> None:
        try:
            with read_frames(self._video) as frames:
                for frame in frames:
                    if self._stop.is_set() or frame.index > self._last:
                        return
                    if self._wanted(frame.index):
                        self._add(frame.index, frame.image)
        except VideoError as error:
            self.error = str(error)
        finally:
            self._complete.set()

    def _wanted(self, index: int) -> bool:
        return index >= self._first and (index - self._first) % self._stride == 0

    def _add(self, index: int, image: Image) -> None:
        encoded = encode_jpeg(shrink(image, MAX_WIDTH), JPEG_QUALITY)
        with self._lock:
            self._indices.append(index)
            self._encoded.append(encoded)
        if self._on_frame is not None:
            self._on_frame(index)
