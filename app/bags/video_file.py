"""A clip's video as the studio keeps it: H.264 in MP4, every frame at its own time."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import Self

import av
from av.video.stream import VideoStream

from app.recognition.estimation.base import Image

TICK = Fraction(1, 1_000_000)
"""Seconds: MP4 counts the time between frames in 32 bits, which in microseconds is an hour."""

QUALITY = {"crf": "18", "preset": "veryfast", "bf": "0"}
"""Of x264: 18 is where its losses stop being seen; no frames out of order, so that players that
step do it exactly. The landmarks come from the recording's own pictures, not from this copy."""


class VideoFile:
    """Writes frames of one even size; a context that ends well leaves a whole file.

    Parameters
    ----------
    path
        Where to write; its ending does not matter.
    width, height
        Pixels, both even.

    """

    def __init__(self, path: Path, width: int, height: int) -> None:
        # The index first: a browser plays it while it is still being fetched.
        options = {"movflags": "faststart"}
        self._container = av.open(str(path), "w", format="mp4", options=options)
        stream = self._container.add_stream("libx264", options=dict(QUALITY))
        assert isinstance(stream, VideoStream)
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.time_base = stream.codec_context.time_base = TICK
        self._stream = stream

    def add(self, image: Image, time: float) -> None:
        """Append a frame ``(height, width, 3)`` RGB at `time` seconds, later than the last one."""
        frame = av.VideoFrame.from_ndarray(image, format="rgb24")
        frame.pts, frame.time_base = round(time / TICK), TICK
        self._container.mux(self._stream.encode(frame))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if error is None:
            self._container.mux(self._stream.encode())
        self._container.close()
