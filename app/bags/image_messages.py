"""Decoders of image messages: raw in ROS's encodings, compressed by FFmpeg."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

import av
import cv2
import numpy as np
from av.codec.context import CodecContext
from av.video.codeccontext import VideoCodecContext

from app.recognition.errors import BagError
from app.recognition.poses.frame import Image
from app.recognition.recording.video_limits import VideoLimits

NANOSECONDS = Fraction(1, 1_000_000_000)

_Conversion = Callable[[Any], Any]

_CHANNELS: dict[str, tuple[int, int | None]] = {
    "rgb8": (3, None),
    "bgr8": (3, cv2.COLOR_BGR2RGB),
    "8UC3": (3, cv2.COLOR_BGR2RGB),
    "rgba8": (4, cv2.COLOR_RGBA2RGB),
    "bgra8": (4, cv2.COLOR_BGRA2RGB),
    "8UC4": (4, cv2.COLOR_BGRA2RGB),
    "mono8": (1, cv2.COLOR_GRAY2RGB),
    "8UC1": (1, cv2.COLOR_GRAY2RGB),
    # ROS names a Bayer pattern by its first two pixels, OpenCV by two of its second row.
    "bayer_rggb8": (1, cv2.COLOR_BayerBG2RGB),
    "bayer_bggr8": (1, cv2.COLOR_BayerRG2RGB),
    "bayer_gbrg8": (1, cv2.COLOR_BayerGR2RGB),
    "bayer_grbg8": (1, cv2.COLOR_BayerGB2RGB),
    "yuv422": (2, cv2.COLOR_YUV2RGB_UYVY),
    "uyvy": (2, cv2.COLOR_YUV2RGB_UYVY),
    "yuv422_yuy2": (2, cv2.COLOR_YUV2RGB_YUY2),
    "yuyv": (2, cv2.COLOR_YUV2RGB_YUY2),
}
"""Bytes a pixel of each 8-bit encoding, and OpenCV's conversion to RGB; None: it is RGB."""

_SHARED_COLOUR = ("yuv422", "uyvy", "yuv422_yuy2", "yuyv")
"""Encodings in which two neighbours share a colour, so that rows have an even number of pixels."""

_DEEP = {"rgb16": "rgb8", "bgr16": "bgr8", "mono16": "mono8", "16UC1": "mono8"}
"""Encodings with 16 bits, and their equivalents with only the upper 8 bits."""

ENCODINGS = (*_CHANNELS, *_DEEP)

_CODECS = {"h264": "h264", "libx264": "h264", "h265": "hevc", "hevc": "hevc", "vp9": "vp9"}
"""FFmpeg's decoder for each format name in packets."""


def raw_image(message: Any, limits: VideoLimits) -> Image:
    """Return the picture of a ``sensor_msgs/Image``.

    Raises
    ------
    BagError
        When its encoding is not known, or the size of its data is not as stated or not possible.
    VideoError
        When it is larger than `limits` allow.

    """
    height, width, encoding = int(message.height), int(message.width), str(message.encoding)
    limits.require_pixels(width, height)
    shallow = _DEEP.get(encoding, encoding)
    if shallow not in _CHANNELS:
        raise BagError(
            f"pictures are encoded as {encoding[:40]!r}, which is not known; record them as one of "
            f"{', '.join(ENCODINGS)}"
        )
    channels, conversion = _CHANNELS[shallow]
    pixels = _pixels(message, channels, 2 if encoding in _DEEP else 1)
    if conversion is None:
        return np.ascontiguousarray(pixels)
    return np.asarray(cv2.cvtColor(np.ascontiguousarray(pixels), conversion), dtype=np.uint8)


def _pixels(message: Any, channels: int, depth: int) -> Image:
    """Cut the padding off the rows, and keep the upper byte of deep pixels."""
    height, width = int(message.height), int(message.width)
    row = width * channels * depth
    step = int(message.step) or row  # 0 where a driver leaves it out
    data = np.asarray(message.data, dtype=np.uint8)
    odd = width % 2 == 1 and str(message.encoding) in _SHARED_COLOUR
    if not row or not height or odd or step < row or data.size < step * (height - 1) + row:
        raise BagError(
            f"a picture says {width} x {height} of {message.encoding}, {step} bytes a row, and "
            f"holds {data.size} bytes; the recording is damaged"
        )
    padded = np.zeros(step * height, dtype=np.uint8)
    padded[: min(data.size, padded.size)] = data[: padded.size]
    rows = padded.reshape(height, step)[:, :row]
    if depth == 2:
        rows = rows[:, 0 if message.is_bigendian else 1 :: 2]
    return rows.reshape(height, width, channels) if channels > 1 else rows.reshape(height, width)


class PacketDecoder:
    """Turns compressed pictures or packets of a video stream into RGB.

    Parameters
    ----------
    limits
        Limits of a picture's size.

    """

    def __init__(self, limits: VideoLimits) -> None:
        self._limits = limits
        self._codec: VideoCodecContext | None = None

    def decode(
        self, data: bytes, stated: str, stamp: int | None
    ) -> Iterator[tuple[int | None, Image]]:
        """Decode one message.

        Parameters
        ----------
        data
            A JPEG, a PNG, or a packet of a video stream.
        stated
            Format named in the message; for pictures, the content decides.
        stamp
            Nanoseconds; stamp of the picture in these data, even if others are complete before it;
            None: without one.

        Yields
        ------
        Stamp and ``(height, width, 3)`` RGB of every picture that is complete now.

        Raises
        ------
        BagError
            When the format is not known.
        FFmpegError
            When the data is damaged.

        """
        # A new decoder for each PNG: FFmpeg's adds the remains of the previous picture.
        if self._codec is None or self._codec.name == "png":
            self._codec = self._open(data, stated)
        packet = av.Packet(data)
        packet.pts, packet.time_base = stamp, NANOSECONDS
        yield from self._pictures(packet)

    def rest(self) -> Iterator[tuple[int | None, Image]]:
        """Yield the pictures that a stream with reordered frames still holds back."""
        if self._codec is not None:
            yield from self._pictures(None)

    def _pictures(self, packet: av.Packet[Any] | None) -> Iterator[tuple[int | None, Image]]:
        assert self._codec is not None
        for frame in self._codec.decode(packet):
            self._limits.require_pixels(frame.width, frame.height)
            image = frame.to_ndarray(format="rgb24")
            yield frame.pts, np.asarray(image, dtype=np.uint8)

    def _open(self, data: bytes, stated: str) -> VideoCodecContext:
        codec = CodecContext.create(_codec_of(data, stated), "r")
        assert isinstance(codec, VideoCodecContext)
        codec.options = {"max_pixels": str(self._limits.pixels)}
        return codec


def _codec_of(data: bytes, stated: str) -> str:
    if data[:2] == b"\xff\xd8":
        return "mjpeg"
    if data[:4] == b"\x89PNG":
        return "png"
    # ffmpeg_image_transport appends the pixel format: "h264;yuv420p;bgr8".
    for word in stated.lower().replace(";", " ").replace("_", " ").split():
        if word in _CODECS:
            return _CODECS[word]
    raise BagError(
        f"pictures are compressed as {stated[:40]!r}, which is not known; record JPEG, PNG, H.264, "
        "H.265 or VP9"
    )
