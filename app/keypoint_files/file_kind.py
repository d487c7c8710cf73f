"""File kind: detects a keypoint file by its first bytes, a text file by its name."""

from __future__ import annotations

from typing import Final, Literal, get_args

Ending = Literal[".csv", ".json", ".slp", ".h5", ".zip"]
"""Endings by which `app.keypoint_files.read_keypoints` chooses the reader; an archive holds a
folder of OpenPose."""

_HDF5: Final = b"\x89HDF\r\n\x1a\n"
_ZIP: Final = b"PK\x03\x04"


def keypoint_ending(head: bytes, name: str) -> Ending | None:
    """Return the ending by which a file that begins with `head` is read; None without keypoints.

    Text has no mark of its kind, so its name decides; a file with zero bytes is no text.
    """
    if head.startswith(_ZIP):
        return ".zip"
    lower = name.lower()
    if head.startswith(_HDF5):
        return ".slp" if lower.endswith(".slp") else ".h5"
    named = next((ending for ending in get_args(Ending) if lower.endswith(ending)), None)
    return named if named in (".csv", ".json") and b"\0" not in head else None
