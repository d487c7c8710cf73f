"""Atomic file replacement, durable across a power cut."""

from __future__ import annotations

import os
from pathlib import Path

PARTIAL_SUFFIX = ".part"
"""Ending of files that are still being written; whatever carries it at start is an orphan."""


def sync_directory(directory: Path) -> None:
    """Make the names in `directory` durable; a no-op where directories cannot be opened."""
    if os.name != "posix":
        return
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def publish(partial: Path, target: Path) -> None:
    """Rename a finished `partial` file to `target` in the same directory, durably.

    Raises
    ------
    OSError
        When the disk refuses; `partial` is left for the caller to remove.

    """
    with partial.open("rb") as file:
        os.fsync(file.fileno())
    os.replace(partial, target)  # noqa: PTH105 - the call whose atomicity the module is about
    sync_directory(target.parent)
