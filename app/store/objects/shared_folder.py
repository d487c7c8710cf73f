"""Shared-folder object store: does nothing, because all servers see the same files."""

from __future__ import annotations

from pathlib import Path


class SharedFolder:
    """Object store that consists of the clips' folder itself; see `ObjectStore`."""

    def upload(self, file: Path, name: str) -> None:
        """Do nothing: the file is where all servers look."""

    def download(self, name: str, target: Path) -> bool:
        """Return False: a file that is not in the folder does not exist."""
        return False

    def size(self, name: str) -> int | None:
        """Return None: there is no copy beside the one in the folder."""
        return None

    def remove(self, clip_id: str) -> None:
        """Do nothing: the files go with their folder."""
