"""Folder of clips: which of its files are clips, and how large they are."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from app.clip_sources import SOURCES, VIDEO, is_take


def is_folder_of_clips(path: Path) -> bool:
    """Return whether a path is a folder that is not itself a clip, unlike a bag.

    A folder with JSON files is a clip of OpenPose, unless it also holds videos.
    """
    if not path.is_dir():
        return False
    return not _is_clip(path) or any(VIDEO.is_take(child) for child in path.iterdir())


def list_clips(folder: Path) -> list[Path]:
    """Return the clips in a folder and its subfolders, in the order of their names."""
    return list(_walk(folder))


def measure_bytes(path: Path) -> int:
    """Return the size of a clip, which may be a folder, in bytes."""
    if path.is_dir():
        return sum(each.stat().st_size for each in path.rglob("*") if each.is_file())
    return path.stat().st_size


def _walk(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.iterdir()):
        if path.name.startswith("."):
            continue
        if is_folder_of_clips(path):
            yield from _walk(path)
        elif _is_clip(path):
            yield path


def _is_clip(path: Path) -> bool:
    return is_take(path) or any(source.accepts(path, None) for source in SOURCES)
