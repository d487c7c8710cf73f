"""Staging of a keypoint file: restores its ending, or unpacks it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final
from zipfile import ZipFile, ZipInfo

from app.keypoint_files.openpose import LARGEST_FILE
from app.keypoint_files.registry import Ending
from app.recognition.errors import KeypointFileError
from app.recognition.recording.video_limits import VideoLimits
from app.system.stand_in import stand_in
from app.system.zip_archive import (
    UnpackedTooLarge,
    names_in,
    open_archive,
    plain_name,
    unpack,
    visible_files,
)

MOST_BYTES: Final = 1024 * 1024 * 1024
"""Most bytes after unpacking: the most frames allowed, of three people with face and hands at 6 kB
each."""


@contextmanager
def stage(path: Path, ending: Ending, limits: VideoLimits | None = None) -> Iterator[Path]:
    """Yield the path from which `read_keypoints` reads a file that was stored without its name.

    Parameters
    ----------
    path
        The file.
    ending
        Ending by which it is read; an archive becomes a folder.
    limits
        Limits of the number of frames in an archive.

    Raises
    ------
    KeypointFileError
        When it is an archive that holds no frames of OpenPose, or cannot be unpacked safely.
    VideoError
        When it holds more frames than the limits allow.

    """
    with tempfile.TemporaryDirectory(prefix="keypoints-") as made:
        folder = Path(made)
        if ending == ".zip":
            _unpack(path, folder, limits or VideoLimits())
            yield folder
            return
        place = folder / f"keypoints{ending}"
        stand_in(path, place)
        yield place


def is_openpose_archive(path: Path) -> bool:
    """Return whether `path` is a zip that looks like a folder of OpenPose; only names are read."""
    return path.is_file() and any(map(_is_frame, names_in(path)))


def _unpack(path: Path, folder: Path, limits: VideoLimits) -> None:
    with open_archive(path, "the archive", KeypointFileError) as archive:
        frames = _frames(archive)
        limits.require_frames(len(frames))
        try:
            unpack(archive, frames, folder, most_bytes=MOST_BYTES, most_bytes_each=LARGEST_FILE)
        except UnpackedTooLarge as error:
            raise KeypointFileError(
                "the archive unpacks to more than frames of OpenPose can be (at "
                f"{error.name!r}); pack the folder that --write_json wrote, and nothing else"
            ) from error


def _frames(archive: ZipFile) -> dict[str, ZipInfo]:
    """Return the entries of frames by their plain names; no others are read."""
    frames: dict[str, ZipInfo] = {}
    for entry in visible_files(archive):
        name = plain_name(entry)
        if not _is_frame(name):
            continue
        if name in frames:
            raise KeypointFileError(
                f"the archive holds {name!r} twice; pack the folder of one clip at a time"
            )
        frames[name] = entry
    if not frames:
        raise KeypointFileError(
            "the archive holds no frames of OpenPose (*_keypoints.json); pack the folder that "
            "--write_json wrote"
        )
    return frames


def _is_frame(name: str) -> bool:
    return name.lower().endswith(".json")
