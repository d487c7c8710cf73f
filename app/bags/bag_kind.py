"""Kind of a dive recording by its content: MCAP, SQLite, zip, folder, ROS 1."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal

from app.recognition.recording.chapters import in_order

BagKind = Literal["mcap", "sqlite3", "zip", "folder", "ros1"]
"""A single file of either storage, an archive of a recording's folder, the folder itself, and the
format of ROS 1, which is detected only to refuse it by name."""

METADATA = "metadata.yaml"
"""The file that makes a folder a rosbag2."""

_PART = re.compile(r"(.+_)(\d{1,6})(\.mcap|\.db3)")
"""Name of a part of a recording that was split, with its number."""

_BEGINNINGS: dict[bytes, BagKind] = {
    b"\x89MCAP0\r\n": "mcap",
    b"SQLite format 3\0": "sqlite3",
    b"PK\x03\x04": "zip",
    b"#ROSBAG V": "ros1",
}


HEAD_BYTES = max(map(len, _BEGINNINGS))
"""Bytes from the beginning of a file that `bag_kind` needs."""


def bag_kind(head: bytes) -> BagKind | None:
    """Return the kind of recording that begins with `head`, or None; a zip may hold other files."""
    return next((kind for start, kind in _BEGINNINGS.items() if head.startswith(start)), None)


def split_parts(folder: Path) -> list[Path]:
    """Return the storage files of a folder in order, if they are numbered parts of one recording.

    Such a recording has lost its metadata, as when the power fails. Empty if the order is unknown.
    """
    files = [each for each in folder.iterdir() if each.suffix in (".mcap", ".db3")]
    return in_order(files, [_PART])


def kind_of(path: Path) -> BagKind | None:
    """Return the kind of the recording at `path`, or None if there is none."""
    if path.is_dir():
        return "folder" if (path / METADATA).is_file() or split_parts(path) else None
    if not path.is_file():
        return None
    with path.open("rb") as file:
        return bag_kind(file.read(HEAD_BYTES))


def bag_and_topic(text: str) -> tuple[Path, str | None]:
    """Split ``BAG@/TOPIC``; an existing file of exactly that name is taken as it is."""
    match = re.fullmatch(r"(.+)@(/[\w/]+)", text)
    if match is None or Path(text).exists():
        return Path(text), None
    return Path(match[1]), match[2]
