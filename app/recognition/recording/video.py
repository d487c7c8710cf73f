"""Video decoding: untrusted clips as upright RGB frames with timestamps, by FFmpeg through PyAV.

The format is detected from the content, never from the name. Only the containers in `CONTAINERS`
and the protocol `file` are enabled, so that a playlist or a reference inside a file can open
neither another file nor a network address. A malicious file may still hang or crash a decoder: run
this in a process of its own with a time limit, as jobs do.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Literal, Protocol

import av
import numpy as np
from av.container import InputContainer
from av.stream import Disposition
from av.video.frame import VideoFrame as DecodedFrame
from av.video.reformatter import VideoReformatter
from av.video.stream import VideoStream
from typing_extensions import Self

from app.recognition.errors import VideoError
from app.recognition.poses.frame import Image
from app.recognition.recording.file_kinds import describe_unreadable
from app.recognition.recording.timestamps import FALLBACK_STEP, FrameClock
from app.recognition.recording.video_limits import VideoLimits

CONTAINERS = ("mov", "mp4", "matroska", "webm", "avi", "mpegts", "mpeg")
"""Names of the FFmpeg demuxers that may open a clip: what phones, action and dive cameras, screen
recorders and browsers write. None of them is a playlist."""

Turn = Literal[0, 90, 180, 270]
"""Degrees, clockwise, by which pictures are turned after what their container states."""

ByteRange = tuple[int, int]
"""First byte of a video that is a part of a file, and the one after its last."""

ALPHA_BACKGROUND = 128
"""Grey, 0 to 255, behind transparent pixels: halfway, so that dark and bright divers stand out."""

DECODER_THREADS = 2
"""Threads of the decoder: two decode while the models run; each further one holds a frame more."""

MISSING_SHARE, MISSING_SECONDS = 0.1, 0.5
"""Share and seconds of the stated duration that may be missing at the end, whichever is greater,
before a clip counts as cut short: containers round, and sound may last a little longer."""

COVER = Disposition.attached_pic | Disposition.timed_thumbnails
"""Streams of pictures that are no video."""

MOST_STREAMS = 64
"""Most streams that FFmpeg may open; a film with many languages has fewer."""


@dataclass(frozen=True)
class VideoInfo:
    """A clip's metadata, before all of it is read.

    Attributes
    ----------
    width, height
        Of the upright picture with square pixels.
    duration
        Seconds, or None when the container does not state it.
    frames
        Number of frames, or None when the container does not state it (Matroska never does).
    rotation
        Degrees, counter-clockwise, by which the stored picture is turned to be upright, as the
        container and the reader's `Turn` say: 0, 90, 180 or 270.
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
        Number of frames before this one.
    time
        Seconds after the first frame, from the container (see `FrameClock`).
    image
        ``(height, width, 3)`` RGB, upright, of the size that `VideoInfo` states.

    """

    index: int
    time: float
    image: Image


class FrameSource(Protocol):
    """The interface of sources of frames, whatever the file format."""

    @property
    def info(self) -> VideoInfo:
        """The clip's metadata."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Problems of the frames read so far, as sentences."""

    def __iter__(self) -> Iterator[VideoFrame]:
        """Go through the frames once, in order."""


class FrameReader(Iterator[VideoFrame]):
    """Iterates over the frames of a clip, decoding one at a time; few are in memory.

    Of a damaged clip the readable frames are returned, and `warnings` counts them.

    Parameters
    ----------
    path
        The file.
    limits
        Checked from the metadata when opened, and again for every decoded frame.
    turn
        By how much the pictures are turned, of a clip whose container does not say it.

    Attributes
    ----------
    info
        The clip's metadata.

    Raises
    ------
    VideoError
        When the file is no video, holds no readable frame, or breaks a limit.

    """

    def __init__(self, path: str | Path, limits: VideoLimits | None = None, turn: Turn = 0) -> None:
        self._path = Path(path)
        self._limits = limits or VideoLimits()
        self._count = 0
        self._faults = 0
        self._broken = False
        self._ended = False
        self._time = 0.0
        self._reformatter = VideoReformatter()
        self._first: DecodedFrame | None = None
        self._size: tuple[int, int] | None = None
        self._resized: tuple[float, tuple[int, int]] | None = None
        self._container = open_video(self._path, self._limits)
        self._decoded = self._decode()
        try:
            self._stream = video_stream(self._container, self._path)
            self._check_statement()
            self._clock = FrameClock(step=nominal_step(self._stream))
            self._first = next(self._decoded, None)
            if self._first is None:
                raise VideoError(
                    f"{self._path.name}: no frame of its {self._stream.codec_context.name} video "
                    "can be read, the file is damaged or cut short; record or export it again"
                )
            self.info = _info(self._container, self._stream, self._first, turn)
            self._limits.require_pixels(self.info.width, self.info.height)
        except BaseException as error:
            self.close()
            if isinstance(error, VideoError):
                _require_jpeg_pixels(self._path, self._limits)
            raise

    def __next__(self) -> VideoFrame:
        """Decode the next frame.

        Raises
        ------
        VideoError
            When the clip breaks a limit.

        """
        frame, self._first = self._first, None
        if frame is None:
            frame = next(self._decoded, None)
        if frame is None:
            self.close()
            raise StopIteration
        self._limits.require_pixels(frame.width, frame.height)
        self._limits.require_frames(self._count + 1)
        size = frame.width, frame.height
        self._size = self._size or size
        stamp = None if frame.pts is None else float(frame.pts * _time_base(frame, self._stream))
        self._time = self._clock.seconds(stamp)
        self._limits.require_seconds(self._time)
        if size != self._size and self._resized is None:
            self._resized = self._time, size
        self._count += 1
        return VideoFrame(index=self._count - 1, time=self._time, image=self._upright(frame))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file; the reader gives no more frames."""
        # A reference cycle with the reader would keep the pictures until garbage collection.
        self._decoded.close()
        self._first = None
        self._container.close()

    @property
    def warnings(self) -> tuple[str, ...]:
        """Problems of the frames read so far, as sentences."""
        found = []
        read = f"{self._count} of {self.info.frames or 'an unknown number of'} frames were read"
        stated = (self.info.duration or 0.0) - sum(self._clock.jumps)
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
        found += self._clock.sentences
        if self._size is not None and self._resized is not None:
            (width, height), (time, (wide, high)) = self._size, self._resized
            verb = "turns" if (width > height) != (wide > high) else "changes its size"
            found.insert(
                0,
                f"the picture {verb} at {time:.1f} s, from {width} x {height} to {wide} x {high}; "
                "cut the clip there, and give each part by itself",
            )
        return tuple(found)

    def _check_statement(self) -> None:
        """Check the limits against the metadata, before decoding."""
        context = self._stream.codec_context
        self._limits.require_pixels(context.width, context.height)
        self._limits.require_frames(self._stream.frames)
        stated = _stated_seconds(self._container, self._stream) or 0.0
        if stated > self._limits.seconds:
            stated -= _measure_jumps(self._path, self._limits)
        self._limits.require_seconds(stated)

    def _decode(self) -> Generator[DecodedFrame, None, None]:
        """Decode frames, counting those that cannot be decoded."""
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
                f"{self._path.name}: frame {self._count} cannot be turned into a picture; record "
                "or export it again"
            ) from error
        image = np.asarray(converted.to_ndarray(), dtype=np.uint8)
        if has_alpha:
            image = over_background(image)
        return np.ascontiguousarray(np.rot90(image, self.info.rotation // 90))


def probe(path: str | Path, limits: VideoLimits | None = None, turn: Turn = 0) -> VideoInfo:
    """Read a clip's metadata, and decode its first frame as a test.

    Raises
    ------
    VideoError
        When the file is no video, holds no readable frame, or breaks a limit.

    """
    with FrameReader(path, limits, turn) as reader:
        return reader.info


def read_frames(path: str | Path, limits: VideoLimits | None = None, turn: Turn = 0) -> FrameReader:
    """Read a clip frame by frame; see `FrameReader`."""
    return FrameReader(path, limits, turn)


def over_background(image: Image) -> Image:
    """Blend a picture with transparency over `ALPHA_BACKGROUND`.

    Parameters
    ----------
    image
        ``(height, width, 4)`` RGB and alpha, not premultiplied.

    Returns
    -------
    ``(height, width, 3)`` RGB.

    """
    alpha = image[..., 3:].astype(np.float32) / 255
    blended = alpha * image[..., :3] + (1 - alpha) * ALPHA_BACKGROUND
    return np.rint(blended).astype(np.uint8)


def open_video(path: Path, limits: VideoLimits, within: ByteRange | None = None) -> InputContainer:
    """Open a video without decoding it; `within` are the bytes of the file that it consists of.

    Raises
    ------
    VideoError
        When the file is no video.

    """
    if not path.is_file():
        raise VideoError(f"{path} is not a file; give the path of a clip")
    if path.stat().st_size == 0:
        raise VideoError(f"{path.name} is empty (0 bytes); copy or record it again")
    part = f"subfile,,start,{within[0]},end,{within[1]},,:" if within else ""
    try:
        return av.open(
            # The scheme prevents names like "concat:a|b" or "http:x" from opening an address.
            f"{part}file:{path.resolve()}",
            container_options={
                "protocol_whitelist": "file,subfile" if within else "file",
                "format_whitelist": ",".join(CONTAINERS),
                "max_streams": str(MOST_STREAMS + 1),
            },
            # Probing may decode a frame already.
            options={"max_pixels": str(limits.pixels)},
            metadata_errors="replace",
        )
    except MemoryError as error:
        raise VideoError(
            f"{path.name} cannot be opened: it needs more memory than is free or allowed; free "
            "memory, or record or export it again"
        ) from error
    except (av.error.FFmpegError, OSError) as error:
        raise VideoError(describe_unreadable(path)) from error


def video_stream(container: InputContainer, path: Path) -> VideoStream:
    """Return the stream of moving pictures; raise VideoError where there is none."""
    # Some demuxers refuse further streams, Matroska's leaves them out.
    if len(container.streams) > MOST_STREAMS:
        raise VideoError(
            f"{path.name} holds more streams than the limit of {MOST_STREAMS}; export its picture "
            "alone"
        )
    best = container.streams.best("video")
    # The cover of a song is a stream of one picture.
    pictures = [each for each in container.streams.video if not each.disposition & COVER]
    stream = best if best in pictures else next(iter(pictures), None)
    if stream is None:
        others = sorted({other.type for other in container.streams} - {"video"})
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


def _require_jpeg_pixels(path: Path, limits: VideoLimits) -> None:
    """Raise VideoError when the first picture of a Motion JPEG clip is larger than allowed.

    FFmpeg refuses pictures beyond a size of its own as if they were damaged.
    """
    with suppress(av.error.FFmpegError, OSError, IndexError), open_video(path, limits) as container:
        stream = container.streams.video[0]
        context = stream.codec_context
        if context is not None and context.codec is not None and context.name == "mjpeg":
            packet = next(container.demux(stream))
            if (size := read_jpeg_size(bytes(packet))) is not None:
                limits.require_pixels(*size)


def nominal_step(stream: VideoStream) -> float:
    """Return the seconds from one frame to the next, as the container says."""
    rate = stream.average_rate or stream.guessed_rate
    return float(1 / rate) if rate else FALLBACK_STEP


def _time_base(frame: DecodedFrame, stream: VideoStream) -> Fraction:
    return frame.time_base or stream.time_base or Fraction(1, av.time_base)


def _stated_seconds(
    container: InputContainer, stream: VideoStream, first: DecodedFrame | None = None
) -> float | None:
    if stream.duration is not None and stream.time_base is not None:
        whole = float(stream.duration * stream.time_base)
    elif container.duration is not None:
        whole = container.duration / av.time_base
    else:
        return None
    begun = (container.start_time or 0) / av.time_base
    if not begun and first is not None and first.pts is not None:
        begun = float(first.pts * _time_base(first, stream))
    # Matroska counts from 0, not from its first frame.
    return whole - begun if "matroska" in container.format.name and 0 < begun < whole else whole


def _measure_jumps(path: Path, limits: VideoLimits) -> float:
    """Return by how many seconds the clock of a clip is set ahead, without decoding it."""
    clock = FrameClock()
    with suppress(av.error.FFmpegError, OSError), open_video(path, limits) as container:
        for packet in container.demux(video_stream(container, path)):
            if packet.dts is None or packet.time_base is None:
                continue
            if clock.seconds(float(packet.dts * packet.time_base)) > limits.seconds:
                break
    return sum(clock.jumps)


def _info(
    container: InputContainer, stream: VideoStream, frame: DecodedFrame, turn: Turn
) -> VideoInfo:
    width, height = frame.width, frame.height
    aspect = float(stream.sample_aspect_ratio or 1)
    # Anything beyond is a broken header: anamorphic video squeezes by two at most.
    if 0.25 <= aspect <= 4:
        width = max(1, round(width * aspect))
    rotation = (round(frame.rotation / 90) * 90 - turn) % 360
    if rotation in (90, 270):
        width, height = height, width
    return VideoInfo(
        width=width,
        height=height,
        duration=_stated_seconds(container, stream, frame),
        frames=stream.frames or None,
        rotation=rotation,
        codec=stream.codec_context.name,
    )


_START_OF_FRAME = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers that are followed by the size (ITU-T T.81, table B.1)."""

_WITHOUT_LENGTH = frozenset((*range(0xD0, 0xDA), 0x01))
"""Markers without a segment: restarts, start and end of the picture."""


def read_jpeg_size(picture: bytes) -> tuple[int, int] | None:
    """Return width and height in pixels; None where no header states them."""
    at = 2
    while picture[:2] == b"\xff\xd8" and at + 9 <= len(picture) and picture[at] == 0xFF:
        marker = picture[at + 1]
        if marker in _START_OF_FRAME:
            height = int.from_bytes(picture[at + 5 : at + 7], "big")
            return int.from_bytes(picture[at + 7 : at + 9], "big"), height
        if marker == 0xFF:  # padding
            at += 1
        elif marker in _WITHOUT_LENGTH:
            at += 2
        else:
            at += 2 + max(2, int.from_bytes(picture[at + 2 : at + 4], "big"))
    return None
