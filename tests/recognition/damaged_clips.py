"""Damaged clips: written by PyAV into a test's own folder, never stored.

`write_clip` makes a small clean clip; every other function spoils one in one way.
"""

from __future__ import annotations

import io
import struct
import zipfile
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from av.container import OutputContainer
from av.stream import Disposition
from av.video.stream import VideoStream

from app.recognition.poses.frame import Image

WIDTH, HEIGHT = 64, 48
RATE = 25
TICKS = 1000
"""Ticks per second of the clips' clock: whole milliseconds."""


def picture(index: int, width: int = WIDTH, height: int = HEIGHT) -> Image:
    """Paint red in the top left corner, blue elsewhere, and the frame's number as brightness."""
    image = np.zeros((height, width, 3), dtype=np.uint8)
    image[..., 2] = 100 + index % 100
    image[: height // 2, : width // 2] = (250, 0, 0)
    return image


def write_clip(
    path: Path,
    *,
    frames: int = 12,
    size: tuple[int, int] = (WIDTH, HEIGHT),
    codec: str = "libx264",
    pixel_format: str = "yuv420p",
    times: Sequence[float] | None = None,
    rotation: int | None = None,
    pixel_aspect: Fraction | None = None,
    extra_streams: int = 0,
    options: dict[str, str] | None = None,
    container_format: str | None = None,
) -> Path:
    """Write a clip of `picture` frames.

    Parameters
    ----------
    path
        Its suffix chooses the container, unless `container_format` does.
    times
        Seconds of the frames, `frames` many; None: `RATE` a second.
    rotation
        Rotation stored in the file, in degrees counter-clockwise.
    extra_streams
        Count of further video streams, of one frame each.

    """
    stamps = [i / RATE for i in range(frames)] if times is None else times
    with av.open(str(path), "w", format=container_format, options=options or {}) as container:
        stream = _video_stream(container, codec)
        others = [_video_stream(container, "mpeg4") for _ in range(extra_streams)]
        for each in (stream, *others):
            each.width, each.height = size
            each.pix_fmt = pixel_format if each is stream else "yuv420p"
        stream.time_base = stream.codec_context.time_base = Fraction(1, TICKS)
        if codec == "libx264":
            # No reordering, so that decoding and display order are the same for any timestamps.
            stream.options = {"preset": "ultrafast", "bf": "0"}
        if pixel_aspect is not None:
            stream.codec_context.sample_aspect_ratio = pixel_aspect
        if rotation is not None:
            stream.set_display_rotation(rotation)
        for index, seconds in enumerate(stamps):
            frame = av.VideoFrame.from_ndarray(picture(index, *size), format="rgb24")
            frame = frame.reformat(format=pixel_format)
            frame.pts, frame.time_base = round(seconds * TICKS), Fraction(1, TICKS)
            container.mux(stream.encode(frame))
        for other in others:
            container.mux(other.encode(av.VideoFrame(*size, "yuv420p")))
        for each in (stream, *others):
            container.mux(each.encode())
    return path


def _video_stream(container: OutputContainer, codec: str) -> VideoStream:
    stream = container.add_stream(codec, rate=RATE)
    assert isinstance(stream, VideoStream), f"{codec} is no video codec"
    return stream


def cut_off(clip: Path, share: float) -> Path:
    """Keep only the first `share` of a file's bytes, as after an interrupted transfer."""
    content = clip.read_bytes()
    clip.write_bytes(content[: int(len(content) * share)])
    return clip


def joined(first: Path, second: Path) -> Path:
    """Append one MPEG-TS clip to another, as recorders do: the clock restarts in the middle."""
    first.write_bytes(first.read_bytes() + second.read_bytes())
    return first


def flipped(clip: Path, seed: int, bytes_changed: int) -> Path:
    """Overwrite random bytes anywhere in the file, as on a faulty memory card."""
    random = np.random.default_rng(seed)
    content = np.frombuffer(clip.read_bytes(), dtype=np.uint8).copy()
    places = random.integers(0, len(content), bytes_changed)
    content[places] = random.integers(0, 256, bytes_changed)
    clip.write_bytes(content.tobytes())
    return clip


def huge_motion_jpeg(path: Path, side: int, *, stated: bool) -> Path:
    """Write a Motion JPEG clip whose pictures claim a size that no encoder could make.

    `stated`: whether the container claims that size too.
    """
    write_clip(path, codec="mjpeg", pixel_format="yuvj420p", size=(96, 96), frames=3)
    content = path.read_bytes()
    header, small, large = b"\xff\xc0\x00\x11\x08", (96, 96), (side, side)
    content = content.replace(
        header + struct.pack(">HH", *small), header + struct.pack(">HH", *large)
    )
    if stated:
        content = content.replace(struct.pack("<II", *small), struct.pack("<II", *large))
        content = content.replace(
            struct.pack(">II", 96 << 16, 96 << 16), struct.pack(">II", side << 16, side << 16)
        )
        content = content.replace(struct.pack(">HH", *small), struct.pack(">HH", *large))
    path.write_bytes(content)
    return path


def sound_only(path: Path, cover: bytes = b"") -> Path:
    """Write a clip with half a second of sound and no picture, but for a song's cover (JPEG)."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("aac", rate=16000)
        if cover:
            shown = container.add_stream("mjpeg", rate=1)
            shown.width, shown.height, shown.pix_fmt = WIDTH, HEIGHT, "yuvj420p"
            shown.disposition = Disposition.attached_pic
            packet = av.Packet(cover)
            packet.stream, packet.pts, packet.dts = shown, 0, 0
            container.start_encoding()
            container.mux(packet)
        frame = av.AudioFrame.from_ndarray(
            np.zeros((1, 8000), dtype=np.float32), format="fltp", layout="mono"
        )
        frame.sample_rate = 16000
        container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path


def _zip() -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr("clip.mp4", b"not a clip either")
    return content.getvalue()


def _moov_without_media() -> bytes:
    return struct.pack(">I4s4sI4s", 20, b"ftyp", b"isom", 512, b"isom") + struct.pack(
        ">I4s", 8, b"moov"
    )


IMPOSTORS: dict[str, bytes] = {
    "nothing": b"",
    "one byte": b"\0",
    "page": b"<!doctype html><html><body><video src=x></body></html>" * 20,
    "drawing": b'<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg"></svg>' * 20,
    "archive": _zip(),
    "document": b"%PDF-1.7\n%\xe2\xe3\xcf\xd3\n" + bytes(2000),
    "program": b"\x7fELF\x02\x01\x01" + bytes(2000),
    "text": b"salute, circle, salute\n" * 100,
    "zeros": bytes(4096),
    "noise": np.random.default_rng(1).bytes(4096),
    "MP4 header alone": struct.pack(">I4s4sI4s", 20, b"ftyp", b"isom", 512, b"isom"),
    "MP4 without media": _moov_without_media(),
    "Matroska header alone": bytes.fromhex("1a45dfa3934282886d6174726f736b614287810242858102"),
}
"""Contents that are not a clip, whatever the file's name."""

PLAYLISTS: dict[str, Callable[[Path], str]] = {
    "HLS": lambda clip: f"#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\n{clip}\n#EXT-X-ENDLIST\n",
    "concatenation": lambda clip: f"ffconcat version 1.0\nfile '{clip}'\n",
    "session description": lambda clip: (
        "v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\n"
        f"t=0 0\na=tool:{clip}\nm=video 5004 RTP/AVP 96\na=rtpmap:96 H264/90000\n"
    ),
}
"""Texts that make FFmpeg open another file or address, which they name."""


def of_another_file(path: Path, other: Path) -> Path:
    """Write a QuickTime file whose frames are in another one, which its data reference names."""
    path.write_bytes(_refer(other.read_bytes(), other))
    return path


def _refer(content: bytes, other: Path) -> bytes:
    changed, at = b"", 0
    while at < len(content):
        size, kind = struct.unpack(">I4s", content[at : at + 8])
        inner = content[at + 8 : at + size]
        if kind == b"dref":
            inner = struct.pack(">II", 0, 1) + _box(b"alis", bytes(4) + _alias(other))
        elif kind in (b"moov", b"trak", b"mdia", b"minf", b"dinf"):
            inner = _refer(inner, other)
        elif kind == b"mdat":
            inner = bytes(len(inner))
        changed += _box(kind, inner)
        at += size
    return changed


def _alias(other: Path) -> bytes:
    """Return a Macintosh alias record with the file's absolute path."""
    path, name = str(other).encode(), other.name.encode()
    record = bytes(10) + b"\1" + b"v".ljust(27, b"\0") + bytes(12)
    record += bytes([len(name)]) + name.ljust(63, b"\0") + bytes(16)
    record += struct.pack(">hh", 1, 1) + bytes(16)
    for kind in (2, 18):
        record += struct.pack(">hH", kind, len(path)) + path + bytes(len(path) % 2)
    return record + struct.pack(">hH", -1, 0)


def _box(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I4s", len(content) + 8, kind) + content


def write_program_stream(path: Path, frames: int = 50) -> Path:
    """Write an MPEG program stream as old camcorders do: MPEG-2, 25 frames a second."""
    with av.open(str(path), "w", format="vob") as container:
        stream = container.add_stream("mpeg2video", rate=RATE)
        stream.width, stream.height, stream.pix_fmt = WIDTH, HEIGHT, "yuv420p"
        for index in range(frames):
            grey = np.full((HEIGHT, WIDTH, 3), 4 * index, np.uint8)
            picture = av.VideoFrame.from_ndarray(grey, format="rgb24")
            picture.pts, picture.time_base = index, Fraction(1, RATE)
            container.mux(stream.encode(picture))
        container.mux(stream.encode())
    return path
