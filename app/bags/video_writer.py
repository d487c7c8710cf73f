"""Video writer: writes H.264 with a timestamp per frame."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from av.codec.context import CodecContext
from av.video.codeccontext import VideoCodecContext
from av.video.stream import VideoStream
from typing_extensions import Self

from app.recognition.errors import VideoError
from app.recognition.poses.frame import Image
from app.recognition.recording.video import VideoFrame

TICK = Fraction(1, 1_000_000)
"""Unit of time in seconds: MP4 counts the time between frames in 32 bits, an hour of
microseconds."""

QUALITY = {"crf": "18", "preset": "veryfast", "bf": "0"}
"""Options of x264: at 18 its losses are no longer visible; without reordered frames, players step
exactly. The landmarks come from the recording's own pictures, not from this copy."""

STREAM_QUALITY = "23"
"""Quality of the copy in a bag: x264's default, because the copy is only for viewing."""

KEY_FRAMES = "50"
"""Frames from one key frame to the next: a player that jumps decodes at most two seconds, at the
usual 25 frames a second."""


MOST_SIDE = 16_384
"""Longest side of a picture in pixels: x264 ends the process at a longer one."""


def require_encodable(width: int, height: int) -> None:
    """Raise VideoError when no video of this size can be written."""
    for side, name in ((width, "width"), (height, "height")):
        if side > MOST_SIDE:
            raise VideoError(
                f"pictures are {width} x {height} pixels, and a {name} of more than {MOST_SIDE} "
                "cannot be written as H.264; give a smaller frame size, or export a smaller picture"
            )


class VideoFile:
    """Writes frames of one size; a context that ends without an error leaves a complete file.

    An odd last row or column is left out, because the usual codecs store only even sizes.

    Parameters
    ----------
    path
        Path of the file; its ending does not matter.
    width, height
        Pixels of the frames.

    Raises
    ------
    VideoError
        When a side is too long.

    """

    def __init__(self, path: Path, width: int, height: int) -> None:
        width, height = width // 2 * 2, height // 2 * 2
        require_encodable(width, height)
        # The index comes first, so that a browser plays the file during its download.
        options = {"movflags": "faststart"}
        self._container = av.open(str(path), "w", format="mp4", options=options)
        stream = self._container.add_stream("libx264", options=dict(QUALITY))
        assert isinstance(stream, VideoStream)
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.time_base = stream.codec_context.time_base = TICK
        self._stream = stream

    def add(self, image: Image, time: float) -> None:
        """Append a frame ``(height, width, 3)`` RGB at `time` seconds, later than the last one."""
        self._container.mux(self._stream.encode(_picture(image, time)))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: object, traceback: object) -> None:
        if error is None:
            self._container.mux(self._stream.encode())
        self._container.close()


def packets(frames: Iterable[VideoFrame]) -> Iterator[tuple[float, bytes]]:
    """Encode frames as separate packets, as Foxglove's ``CompressedVideo`` requires.

    An odd last row or column is left out, because H.264 stores even sizes.

    Yields
    ------
    Seconds of a frame, and its packet: H.264 in Annex B, in order, with the parameter sets before
    every key frame.

    """
    codec: VideoCodecContext | None = None
    times: list[float] = []
    for frame in frames:
        picture = _picture(frame.image, frame.time)
        codec = codec or _stream_encoder(picture.width, picture.height)
        times.append(frame.time)
        for packet in codec.encode(picture):
            yield times.pop(0), bytes(packet)
    if codec is not None:
        for packet in codec.encode(None):
            yield times.pop(0), bytes(packet)


def _picture(image: Image, time: float) -> av.VideoFrame:
    """Return a picture for an encoder at `time` seconds, without an odd last row or column."""
    height, width = (side // 2 * 2 for side in image.shape[:2])
    even = np.ascontiguousarray(image[:height, :width])
    picture = av.VideoFrame.from_ndarray(even, format="rgb24")
    picture.pts, picture.time_base = round(time / TICK), TICK
    return picture


def _stream_encoder(width: int, height: int) -> VideoCodecContext:
    codec = CodecContext.create("libx264", "w")
    assert isinstance(codec, VideoCodecContext)
    codec.width, codec.height, codec.pix_fmt = width, height, "yuv420p"
    codec.time_base = TICK
    codec.options = {**QUALITY, "crf": STREAM_QUALITY, "tune": "zerolatency", "g": KEY_FRAMES}
    return codec
