"""Clips as upright RGB frames with seconds, read by FFmpeg through PyAV, from files nobody trusts.

What a file is, its content decides, never its name. Only the containers in `CONTAINERS` are
recognised and only the protocol `file` is open to FFmpeg, so that a playlist or a reference
inside the file can open neither another file nor a network address. A fuzzed file may still hang
or crash a decoder: run this where a crash does no harm and time is limited (a job's process).
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Protocol

import av
import numpy as np
from av.container import InputContainer
from av.video.frame import VideoFrame as DecodedFrame
from av.video.reformatter import VideoReformatter
from av.video.stream import VideoStream
from typing_extensions import Self

from app.recognition.errors import VideoError
from app.recognition.poses.frame import Image
from app.recognition.recording.timestamps import FALLBACK_STEP, FrameClock
from app.recognition.recording.video_limits import VideoLimits

__all__ = [
    "FrameReader",
    "FrameSource",
    "VideoFrame",
    "VideoInfo",
    "VideoLimits",
    "over_background",
    "probe",
    "read_frames",
]

CONTAINERS = ("mov", "mp4", "matroska", "webm", "avi", "mpegts")
"""Names of the FFmpeg demuxers that may open a clip: what phones, action and dive cameras, screen
recorders and browsers write. None of them is a playlist."""

ALPHA_BACKGROUND = 128
"""Grey, 0 to 255, that shines through transparent pixels: halfway, so that neither a dark nor a
bright diver vanishes against it."""

DECODER_THREADS = 2
"""Threads of the decoder. Two keep decoding off the time of the models; each further one holds
one more frame in memory."""

MISSING_SHARE, MISSING_SECONDS = 0.1, 0.5
"""Of the stated duration, what may be missing at the end before a clip counts as cut short (the
greater one holds); containers round, and sound may last a little longer than the picture."""

MOST_STREAMS = 64
"""Streams that FFmpeg may set up; a film with every language of sound has fewer."""


@dataclass(frozen=True)
class VideoInfo:
    """What a clip says about itself, before all of it is read.

    Attributes
    ----------
    width, height
        Of the upright picture with square pixels.
    duration
        Seconds, or None when the container does not say.
    frames
        Count of frames, or None when the container does not say (Matroska never does).
    rotation
        Degrees, counter-clockwise, by which the stored picture is turned to be upright:
        0, 90, 180 or 270.
    codec
        FFmpeg's name of the video codec.

    """

    width: int
    height: int
    duration: float | None
    frames: int | None
    rotation: int
    codec: str


@dataclass(frozen=True, eq=False)
class VideoFrame:
    """One frame of a clip.

    Attributes
    ----------
    index
        Count of frames before this one.
    time
        Seconds after the first frame, from the container (see `FrameClock`).
    image
        ``(height, width, 3)`` RGB, upright, of the size that `VideoInfo` states.

    """

    index: int
    time: float
    image: Image


class FrameSource(Protocol):
    """The frames of one clip, whatever file they lie in."""

    @property
    def info(self) -> VideoInfo:
        """What the clip says about itself."""
        ...

    @property
    def warnings(self) -> tuple[str, ...]:
        """Say in sentences what was wrong with the frames read so far."""
        ...

    def __iter__(self) -> Iterator[VideoFrame]:
        """Go through the frames once, in order."""
        ...


class FrameReader(Iterator[VideoFrame]):
    """The frames of one clip, decoded one at a time; at most a handful are in memory.

    A damaged clip gives the frames that can be read; `warnings` then says how many.

    Parameters
    ----------
    path
        The file.
    limits
        Checked here from what the file states, and again for every frame decoded.

    Attributes
    ----------
    info
        What the clip says about itself.

    Raises
    ------
    VideoError
        When the file is no video, holds no readable frame, or breaks a limit.

    """

    def __init__(self, path: str | Path, limits: VideoLimits | None = None) -> None:
        self._path = Path(path)
        self._limits = limits or VideoLimits()
        self._count = 0
        self._faults = 0
        self._broken = False
        self._ended = False
        self._time = 0.0
        self._reformatter = VideoReformatter()
        self._first: DecodedFrame | None = None
        self._container = _opened(self._path, self._limits)
        self._decoded = self._decode()
        try:
            self._stream = _video_stream(self._container, self._path)
            self._check_statement()
            self._clock = FrameClock(step=_nominal_step(self._stream))
            self._first = next(self._decoded, None)
            if self._first is None:
                raise VideoError(
                    f"{self._path.name}: no frame of its {_codec(self._stream)} video can be "
                    "read, the file is damaged or cut short; record or export it again"
                )
            self.info = _info(self._container, self._stream, self._first)
            self._limits.require_pixels(self.info.width, self.info.height)
        except BaseException:
            self.close()
            raise

    def __next__(self) -> VideoFrame:
        """Decode the next frame.

        Raises
        ------
        VideoError
            When the clip breaks a limit after all.

        """
        frame, self._first = self._first, None
        if frame is None:
            frame = next(self._decoded, None)
        if frame is None:
            self.close()
            raise StopIteration
        self._limits.require_pixels(frame.width, frame.height)
        self._limits.require_frames(self._count + 1)
        stamp = None if frame.pts is None else float(frame.pts * _time_base(frame, self._stream))
        self._time = self._clock.seconds(stamp)
        self._limits.require_seconds(self._time)
        self._count += 1
        return VideoFrame(index=self._count - 1, time=self._time, image=self._upright(frame))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; the reader gives no more frames."""
        # It knows the reader: together they would keep the pictures until Python collects.
        self._decoded.close()
        self._first = None
        self._container.close()

    @property
    def warnings(self) -> tuple[str, ...]:
        """Say in sentences what was wrong with the frames read so far."""
        found = []
        read = f"{self._count} of {self.info.frames or 'an unknown number of'} frames were read"
        stated = self.info.duration or 0.0
        if self._broken or self._faults:
            found.append(f"the clip is damaged: {read}, {self._faults} pieces of data were not")
        elif self._ended and stated - self._time > max(MISSING_SECONDS, MISSING_SHARE * stated):
            found.append(
                f"the clip is cut short: {read}, up to {self._time:.1f} s of the {stated:.1f} s "
                "that it states"
            )
        if self._clock.repaired:
            found.append(
                f"{self._clock.repaired} of {self._count} frames had no usable timestamp; "
                "their time is estimated"
            )
        return tuple(found)

    def _check_statement(self) -> None:
        """Refuse before decoding what the file itself says is too much."""
        context = self._stream.codec_context
        self._limits.require_pixels(context.width, context.height)
        self._limits.require_frames(self._stream.frames)
        self._limits.require_seconds(_stated_seconds(self._container, self._stream) or 0.0)

    def _decode(self) -> Generator[DecodedFrame, None, None]:
        """Decode what can be decoded, counting what cannot."""
        packets = self._container.demux(self._stream)
        while True:
            try:
                packet = next(packets, None)
            except (av.error.FFmpegError, OSError):
                self._broken = True
                return
            if packet is None:
                self._ended = True
                return
            self._faults += packet.is_corrupt
            try:
                yield from packet.decode()
            except av.error.FFmpegError:
                self._faults += not packet.is_corrupt

    def _upright(self, frame: DecodedFrame) -> Image:
        """Convert to RGB with square pixels, turned upright, of the clip's one size."""
        sideways = self.info.rotation in (90, 270)
        width, height = self.info.width, self.info.height
        if sideways:
            width, height = height, width
        has_alpha = any(component.is_alpha for component in frame.format.components)
        try:
            converted = self._reformatter.reformat(
                frame, width=width, height=height, format="rgba" if has_alpha else "rgb24"
            )
        except av.error.FFmpegError as error:
            raise VideoError(
                f"{self._path.name}: frame {self._count} cannot be turned into a picture "
                f"({error.strerror or error}); record or export it again"
            ) from error
        image = np.asarray(converted.to_ndarray(), dtype=np.uint8)
        if has_alpha:
            image = over_background(image)
        return np.ascontiguousarray(np.rot90(image, self.info.rotation // 90))


def probe(path: str | Path, limits: VideoLimits | None = None) -> VideoInfo:
    """Read what a clip says about itself, and decode its first frame to prove that it can be.

    Raises
    ------
    VideoError
        When the file is no video, holds no readable frame, or breaks a limit.

    """
    with FrameReader(path, limits) as reader:
        return reader.info


def read_frames(path: str | Path, limits: VideoLimits | None = None) -> FrameReader:
    """Read a clip frame by frame; see `FrameReader`."""
    return FrameReader(path, limits)


def over_background(image: Image, grey: int = ALPHA_BACKGROUND) -> Image:
    """Put a picture with transparency on a plain background.

    Parameters
    ----------
    image
        ``(height, width, 4)`` RGB and alpha, not premultiplied.
    grey
        The background's brightness, 0 to 255.

    Returns
    -------
    ``(height, width, 3)`` RGB.

    """
    alpha = image[..., 3:].astype(np.float32) / 255
    blended = alpha * image[..., :3] + (1 - alpha) * grey
    return np.rint(blended).astype(np.uint8)


def _opened(path: Path, limits: VideoLimits) -> InputContainer:
    if not path.is_file():
        raise VideoError(f"{path} is not a file; give the path of a clip")
    if path.stat().st_size == 0:
        raise VideoError(f"{path.name} is empty (0 bytes); copy or record it again")
    try:
        return av.open(
            # The scheme keeps a name like "concat:a|b" or "http:x" from being read as an address.
            f"file:{path.resolve()}",
            container_options={
                "protocol_whitelist": "file",
                "format_whitelist": ",".join(CONTAINERS),
                "max_streams": str(MOST_STREAMS),
            },
            # Probing may decode a frame already.
            options={"max_pixels": str(limits.pixels)},
            metadata_errors="replace",
        )
    except (av.error.FFmpegError, OSError) as error:
        raise VideoError(
            f"{path.name} is not a readable video: it is no MP4, MOV, MKV, WebM, AVI or MPEG-TS "
            f"file, or its index is cut off ({error.strerror or error}); record or export it again"
        ) from error


def _video_stream(container: InputContainer, path: Path) -> VideoStream:
    stream = container.streams.best("video")
    if not isinstance(stream, VideoStream):
        others = sorted({other.type for other in container.streams})
        raise VideoError(
            f"{path.name} holds no video, only {others or 'nothing'}; choose a clip with a picture"
        )
    context = stream.codec_context
    if context is None or context.codec is None or not context.width:
        raise VideoError(
            f"{path.name}: its video has no known codec or no size, the file is damaged or cut "
            "short; record or export it again"
        )
    context.thread_count = DECODER_THREADS
    context.thread_type = "AUTO"
    return stream


def _nominal_step(stream: VideoStream) -> float:
    rate = stream.average_rate or stream.guessed_rate
    return float(1 / rate) if rate else FALLBACK_STEP


def _codec(stream: VideoStream) -> str:
    return stream.codec_context.name


def _time_base(frame: DecodedFrame, stream: VideoStream) -> Fraction:
    return frame.time_base or stream.time_base or Fraction(1, av.time_base)


def _stated_seconds(container: InputContainer, stream: VideoStream) -> float | None:
    if stream.duration is not None and stream.time_base is not None:
        return float(stream.duration * stream.time_base)
    return None if container.duration is None else container.duration / av.time_base


def _info(container: InputContainer, stream: VideoStream, frame: DecodedFrame) -> VideoInfo:
    width, height = frame.width, frame.height
    aspect = float(stream.sample_aspect_ratio or 1)
    # Anything beyond is a broken header: anamorphic video squeezes by two at most.
    if 0.25 <= aspect <= 4:
        width = max(1, round(width * aspect))
    rotation = round(frame.rotation / 90) * 90 % 360
    if rotation in (90, 270):
        width, height = height, width
    return VideoInfo(
        width=width,
        height=height,
        duration=_stated_seconds(container, stream),
        frames=stream.frames or None,
        rotation=rotation,
        codec=_codec(stream),
    )
