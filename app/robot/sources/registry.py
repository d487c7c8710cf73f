"""A source by what the user calls it. A further kind of source is one more entry of `KINDS`."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from app.bags import bag_and_topic, is_bag
from app.recognition.recording.video import FrameReader
from app.robot.sources.bag import open_bag
from app.robot.sources.cameras import CameraDevice, NetworkStream, is_address, without_password
from app.robot.sources.live import LiveSource
from app.robot.sources.recorded import RecordedSource
from app.robot.sources.source import Source


@dataclass(frozen=True)
class SourceKind:
    """One kind of source, recognised by its text.

    Attributes
    ----------
    accepts
        Tells whether a text names a source of this kind.
    open
        Opens it; raises a `OsgError` that says what to do when that fails.

    """

    accepts: Callable[[str], bool]
    open: Callable[[str], Source]


def is_device(text: str) -> bool:
    """Tell whether a text is the number of a camera or its device file."""
    return re.fullmatch(r"\d{1,2}|/dev/video\d{1,2}", text) is not None


def open_camera(text: str) -> Source:
    """Open a camera of this machine by number or device file."""
    device = int(text) if text.isdigit() else text
    return LiveSource(f"camera {text}", partial(CameraDevice, device))


def open_stream(address: str) -> Source:
    """Open a stream from the network."""
    return LiveSource(without_password(address), partial(NetworkStream, address))


def is_recording(text: str) -> bool:
    """Tell whether a text names a dive recording, with or without its topic."""
    return is_bag(bag_and_topic(text)[0])


def open_clip(path: str) -> Source:
    """Open a video file."""
    reader = FrameReader(path)
    return RecordedSource(path, reader, reader.close)


KINDS: tuple[SourceKind, ...] = (
    SourceKind(is_device, open_camera),
    SourceKind(is_address, open_stream),
    SourceKind(is_recording, open_bag),
    SourceKind(lambda text: True, open_clip),
)
"""The first that accepts a text opens it. Clips come last: any other text is a file's path."""


def open_source(text: str) -> Source:
    """Open what a user calls a source.

    Parameters
    ----------
    text
        A camera's number (``0``) or device file (``/dev/video0``), a stream's address
        (``rtsp://...``, ``http://...``), the path of a dive recording (``BAG`` or
        ``BAG@/TOPIC``) or of a clip.

    Raises
    ------
    SourceError
        When a camera or stream cannot be opened.
    VideoError
        When a file is no clip.
    BagError
        When a dive recording cannot be read, or has no such topic of pictures.

    """
    return next(kind for kind in KINDS if kind.accepts(text)).open(text)
