"""Registry of a robot's sources: cameras, streams, and the files of `app.clip_sources`."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from app.bags import bag_and_topic
from app.clip_sources import VIDEO, ReadOptions, source_of
from app.recognition.errors import SourceError
from app.recognition.recording.video import FrameSource, Turn
from app.robot.events import SourceWarned
from app.robot.sources.cameras import (
    CameraDevice,
    NetworkStream,
    is_address,
    is_description_file,
    without_password,
)
from app.robot.sources.live import LiveSource, TurnedCamera
from app.robot.sources.source import Frame, Notice, Source


class RecordedSource:
    """A video file or dive recording; a `Source` that is not live.

    Parameters
    ----------
    name
        Name for people.
    frames
        Open iterator over the frames.
    release
        Closes the file that they are read from; may be called twice.

    """

    live = False
    began = None

    def __init__(self, name: str, frames: FrameSource, release: Callable[[], None]) -> None:
        self.name = name
        self._frames = frames
        self._release = release

    @property
    def frame_size(self) -> tuple[int, int]:
        """Width and height in pixels of every frame."""
        return self._frames.info.width, self._frames.info.height

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Yield every frame, then the warnings about the recording.

        Raises
        ------
        VideoError
            When the recording exceeds a limit that its header did not show.

        """
        time = 0.0
        for frame in self._frames:
            time = frame.time
            yield Frame(time, frame.image)
        for warning in self._frames.warnings:
            yield SourceWarned(time, warning)

    def close(self) -> None:
        """Close the recording; it must not be iterated any more."""
        self._release()


PICTURES = re.compile(r"\.(png|jpe?g|bmp|tiff?|webp)$", re.IGNORECASE)
"""Ending of a picture's name."""


@dataclass(frozen=True)
class SourceKind:
    """One kind of source, recognised by its text.

    Attributes
    ----------
    accepts
        Returns whether a text names a source of this kind.
    open
        Opens it; raises a `OsgError` that says what to do when that fails.

    """

    accepts: Callable[[str], bool]
    open: Callable[[str, Turn], Source]


def is_device(text: str) -> bool:
    """Return whether a text is the number of a camera or its device file."""
    return re.fullmatch(r"\d{1,2}|/dev/video\d{1,2}", text) is not None


def open_camera(text: str, turn: Turn) -> Source:
    """Open a camera of this machine by number or device file."""
    device = int(text) if text.isdigit() else text
    camera = partial(CameraDevice, device)
    return LiveSource(f"camera {text}", partial(TurnedCamera, camera, turn))


def open_stream(address: str, turn: Turn) -> Source:
    """Open a stream from the network."""
    stream = partial(NetworkStream, address)
    return LiveSource(without_password(address), partial(TurnedCamera, stream, turn))


def open_clip(text: str, turn: Turn) -> Source:
    """Open a video file, or a dive recording as ``BAG`` or ``BAG@/TOPIC``."""
    path, topic = bag_and_topic(text)
    if is_picture_sequence(path):
        raise SourceError(
            f"{text} is a sequence of pictures, which have no times; make a clip of it, such as "
            "ffmpeg -framerate 10 -i %04d.png clip.mp4, and give that"
        )
    if path.exists():
        clip = source_of(path, topic).open_frames(path, ReadOptions(topic=topic, turn=turn))
    else:
        clip = VIDEO.open_frames(Path(text), ReadOptions(turn=turn))
    return RecordedSource(text, clip.frames, clip.close)


def is_picture_sequence(path: Path) -> bool:
    """Return whether a path is a pattern such as ``f%04d.png``, or a folder of pictures."""
    if PICTURES.search(path.name):
        return "%" in path.name and not path.exists()
    if not path.is_dir():
        return False
    first = next(path.iterdir(), None)
    return first is not None and PICTURES.search(first.name) is not None


KINDS: tuple[SourceKind, ...] = (
    SourceKind(is_device, open_camera),
    SourceKind(is_address, open_stream),
    SourceKind(is_description_file, open_stream),
    SourceKind(lambda text: True, open_clip),
)
"""Kinds in the order in which they are tried; any other text is the path of a clip."""


def open_source(text: str, turn: Turn = 0) -> Source:
    """Open the source that a user names.

    Parameters
    ----------
    text
        A camera's number (``0``) or device file (``/dev/video0``), a stream's address
        (``rtsp://...``, ``udp://...``) or session description (``.sdp``), the path of a dive
        recording (``BAG`` or ``BAG@/TOPIC``) or of a clip.
    turn
        Degrees, clockwise, by which the pictures are turned: the camera is mounted turned.

    Raises
    ------
    SourceError
        When a camera or stream cannot be opened.
    VideoError
        When the file is no clip.
    BagError
        When a dive recording cannot be read, or has no such topic of pictures.

    """
    return next(kind for kind in KINDS if kind.accepts(text)).open(text, turn)
