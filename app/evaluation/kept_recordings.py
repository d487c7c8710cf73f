"""Recording cache: extracted keypoints of clips, found again by the hash of a clip's content."""

from __future__ import annotations

from pathlib import Path

from platformdirs import user_data_path

from app import __version__
from app.recognition.recording.chapters import chapters_in
from app.recognition.recording.recording import FILE_VERSION
from app.recognition.recording.video import Turn
from app.recognition.text.atomic_files import hash_file

RECORDING_ENDING = ".npz"
"""Ending of the files that `Recording.save` writes."""


def recordings_dir() -> Path:
    """Return the cache folder of recordings in the user's data."""
    kept: Path = user_data_path("osg-studio", appauthor=False) / "recordings"
    return kept


def kept_recording(clip: Path, folder: Path, turn: Turn = 0) -> Path:
    """Return the path of a clip's recording in a cache folder; the file need not exist.

    The name is the hash of the clip's content with the versions of program and file format, and by
    how much its pictures are turned, so that a clip may be renamed or moved, and recordings of
    other versions are not reused.

    Raises
    ------
    OSError
        When the clip, or a chapter in its folder, cannot be read.

    """
    turned = f"-turned-{turn}" if turn else ""
    chapters = chapters_in(clip) if clip.is_dir() else []
    content = hash_file(*(chapters or [clip]))
    return folder / f"{content}-{__version__}-{FILE_VERSION}{turned}{RECORDING_ENDING}"
