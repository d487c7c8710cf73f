"""Object store protocol: keeps whole files by name."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol


class ObjectStore(Protocol):
    """Keeps the files of clips, named ``<clip id>/<file>`` as in the clips' folder."""

    def upload(self, file: Path, name: str) -> None:
        """Store a complete file under `name`, in place of an earlier one.

        Raises
        ------
        StoreUnavailable
            When it cannot be stored now.

        """
        ...

    def download(self, name: str, target: Path) -> bool:
        """Write the file stored under `name` to `target`; return False if there is none.

        Raises
        ------
        StoreUnavailable
            When the store does not answer; `target` may then be incomplete.

        """
        ...

    def size(self, name: str) -> int | None:
        """Return the bytes of the file stored under `name`; None if there is none.

        Raises
        ------
        StoreUnavailable
            When the store does not answer.

        """
        ...

    def remove(self, clip_id: str) -> None:
        """Remove all files of a clip; do nothing if there are none.

        Raises
        ------
        StoreUnavailable
            When some files may be left.

        """
        ...
