"""Registry of keypoint file formats: a new format is a module with a reader and a line here."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final, Literal, get_args

from app.keypoint_files.deeplabcut import is_deeplabcut, read_deeplabcut
from app.keypoint_files.keypoint_table import KeypointOptions, KeypointTable
from app.keypoint_files.mediapipe_json import read_mediapipe_json
from app.keypoint_files.mediapipe_table import read_mediapipe_table
from app.keypoint_files.openpose import is_openpose, read_openpose
from app.keypoint_files.pose_format import BEGINNINGS, read_pose_format
from app.keypoint_files.sleap import read_sleap
from app.recognition.errors import KeypointFileError
from app.recognition.recording.file_kinds import HEAD_BYTES, find_file_kind
from app.recognition.recording.video_limits import VideoLimits
from app.recognition.text.strict_json import is_utf16

Reader = Callable[[Path, KeypointOptions, VideoLimits], KeypointTable]

READERS: Mapping[str, Reader] = {
    ".csv": read_mediapipe_table,
    ".tsv": read_mediapipe_table,
    ".json": read_mediapipe_json,
    ".slp": read_sleap,
    ".h5": read_sleap,
    ".hdf5": read_sleap,
    ".pose": read_pose_format,
}
"""Readers by the file's ending. DeepLabCut's CSV is recognised by its first word, OpenPose by its
folder."""


def is_keypoint_file(path: Path) -> bool:
    """Return whether a file or folder is read as keypoints and not as a video."""
    return is_openpose(path) if path.is_dir() else path.suffix.lower() in READERS


def find_reader(path: Path) -> Reader:
    """Return the reader of a file's or folder's format.

    Raises
    ------
    KeypointFileError
        When there is no such file, or its ending is not that of a keypoint file.

    """
    if path.is_dir():
        return read_openpose
    if not path.is_file():
        raise KeypointFileError(f"{path} is not a file; give the path of a keypoint file")
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise KeypointFileError(
            f"{path.name} is no keypoint file by its ending; there are: {', '.join(READERS)}, and "
            f"folders of OpenPose"
        )
    with path.open("rb") as file:
        kind = find_file_kind(file.read(HEAD_BYTES))
    if kind is not None:
        raise KeypointFileError(f"{path} is {kind.name} and no keypoint file; {kind.remedy}")
    if reader is read_mediapipe_table and is_deeplabcut(path):
        return read_deeplabcut
    return reader


Ending = Literal[".csv", ".tsv", ".json", ".slp", ".h5", ".pose", ".zip"]
"""Endings by which `app.keypoint_files.read_keypoints` chooses the reader; an archive holds a
folder of OpenPose."""

_HDF5: Final = b"\x89HDF\r\n\x1a\n"
_ZIP: Final = b"PK\x03\x04"


def keypoint_ending(head: bytes, name: str) -> Ending | None:
    """Return the ending by which a file that begins with `head` is read; None without keypoints.

    Text has no mark of its kind, so its name decides; a file with zero bytes is no text, unless it
    is a table in UTF-16.
    """
    if head.startswith(_ZIP):
        return ".zip"
    if head[:4] in BEGINNINGS:
        return ".pose"
    lower = name.lower()
    if head.startswith(_HDF5):
        return ".slp" if lower.endswith(".slp") else ".h5"
    named = next((ending for ending in get_args(Ending) if lower.endswith(ending)), None)
    is_text = b"\0" not in head or (named in (".csv", ".tsv") and is_utf16(head))
    return named if named in (".csv", ".tsv", ".json") and is_text else None
