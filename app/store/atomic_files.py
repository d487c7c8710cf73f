"""Atomic file replacement, durable across a power cut."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from app.recognition.text.atomic_files import sync_directory

PARTIAL_SUFFIX = ".part"
"""Suffix of files that are still being written; a file with it at start is an orphan."""


def publish(partial: Path, target: Path) -> None:
    """Rename a finished `partial` file to `target` in the same directory, durably.

    Raises
    ------
    OSError
        When the file cannot be renamed; `partial` is left for the caller to remove.

    """
    with partial.open("rb") as file:
        os.fsync(file.fileno())
    os.replace(partial, target)  # noqa: PTH105 - the call whose atomicity the module is about
    sync_directory(target.parent)


def publish_copy(file: Path, target: Path) -> None:
    """Give a finished `file` a second name `target`, durably; where files have one name, a copy.

    Raises
    ------
    OSError
        When `target` cannot be written; `file` is as it was.

    """
    with file.open("rb") as opened:
        os.fsync(opened.fileno())
    try:
        os.link(file, target)
    except OSError:  # Another file system, or one without hard links.
        partial = target.with_name(f"{target.name}{PARTIAL_SUFFIX}")
        shutil.copyfile(file, partial)
        publish(partial, target)
    sync_directory(target.parent)
