"""Object store protocol: keeps whole files by name."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol


class ObjectStore(Protocol):
    """Keeps the files of clips, named ``<clip id>/<file>`` as in the clips' folder."""

    def upload(self, file: Path, name: str) -> None:
        """Keep a complete file under `name`, in place of an earlier one.

        Raises
        ------
        StoreUnavailable
            When it cannot be kept now.

        """
        ...

    def download(self, name: str, target: Path) -> bool:
        """Write what is kept under `name` to `target`; return False when there is nothing.

        Raises
        ------
        StoreUnavailable
            When the store does not answer; what is at `target` then is of no use.

        """
        ...

    def size(self, name: str) -> int | None:
        """Return the bytes of what is kept under `name`; None when there is nothing.

        Raises
        ------
        StoreUnavailable
            When the store does not answer.

        """
        ...

    def remove(self, clip_id: str) -> None:
        """Remove all that is kept of a clip; nothing happens when that is nothing.

        Raises
        ------
        StoreUnavailable
            When some of it may still be there.

        """
        ...
