"""A keypoint file's place on disk while it is read: under its ending, or unpacked.

What an archive says about itself is not believed: names never become paths, sizes are counted
while they are written.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import Final

from app.keypoint_files.kind import Ending
from app.keypoint_files.openpose import LARGEST_FILE
from app.recognition.errors import KeypointFileError
from app.recognition.video_limits import VideoLimits

MOST_BYTES: Final = 1024 * 1024 * 1024
"""Unpacked. The most frames there may be, of three people with face and hands at 6 kB each."""


@contextmanager
def placed(path: Path, ending: Ending, limits: VideoLimits | None = None) -> Iterator[Path]:
    """Give the place from which `read_keypoints` reads a file that lost its name.

    Parameters
    ----------
    path
        The file.
    ending
        What it is read as; an archive gives a folder.
    limits
        How many frames an archive may hold.

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
        try:
            os.link(path, place)
        except OSError:  # another disk, or one without links
            shutil.copyfile(path, place)
        yield place


def is_openpose_archive(path: Path) -> bool:
    """Tell whether the zip at `path` looks like a folder of OpenPose; names alone are read."""
    try:
        with zipfile.ZipFile(path) as archive:
            return any(_belongs(entry) for entry in archive.infolist())
    except zipfile.BadZipFile:
        return False


def _unpack(path: Path, folder: Path, limits: VideoLimits) -> None:
    try:
        with zipfile.ZipFile(path) as archive:
            entries = _frames(archive)
            limits.require_frames(len(entries))
            left = MOST_BYTES
            for name, entry in entries.items():
                with archive.open(entry) as packed:
                    content = packed.read(LARGEST_FILE + 1)
                left -= len(content)
                if len(content) > LARGEST_FILE or left < 0:
                    raise KeypointFileError(
                        f"the archive unpacks to more than frames of OpenPose can be (at {name!r});"
                        f" pack the folder that --write_json wrote, and nothing else"
                    )
                (folder / name).write_bytes(content)
    except (zipfile.BadZipFile, zipfile.LargeZipFile, NotImplementedError, RuntimeError) as error:
        raise KeypointFileError(
            f"the archive is a damaged, encrypted or unusual zip ({error}); pack the folder again, "
            f"without a password"
        ) from error


def _frames(archive: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """Return the entries of frames by their plain names; those alone are read."""
    frames: dict[str, zipfile.ZipInfo] = {}
    for entry in archive.infolist():
        if not _belongs(entry):
            continue
        name = _base(entry)
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


def _base(entry: zipfile.ZipInfo) -> str:
    return PurePosixPath(entry.filename.replace("\\", "/")).name


def _belongs(entry: zipfile.ZipInfo) -> bool:
    """Tell whether an entry is a frame; hidden ones are notes of the Mac's Finder."""
    name = _base(entry)
    return not entry.is_dir() and not name.startswith(".") and name.lower().endswith(".json")
