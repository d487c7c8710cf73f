"""Lock of the data folder: a second server would remove the first one's uploads."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Self

from app.store.errors import StoreUnavailable


class FolderLock:
    """Holds a folder while the context is open; the system lets go when the process ends.

    Does nothing where POSIX file locks are absent.

    Parameters
    ----------
    folder
        Made when missing.

    Raises
    ------
    StoreUnavailable
        On entering, when another process holds it or the folder cannot be written to.

    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / "lock"
        self._descriptor = -1

    def __enter__(self) -> Self:
        try:
            # Recordings of people: nobody else on this machine needs to see them.
            self._path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            self._descriptor = os.open(self._path, os.O_RDWR | os.O_CREAT, 0o600)
        except OSError as error:
            raise StoreUnavailable(
                f"the data folder {self._path.parent} cannot be written to ({error.strerror}); "
                "choose another one with --data-dir"
            ) from error
        if not self._acquire():
            self._close()
            raise StoreUnavailable(
                f"the data folder {self._path.parent} is in use by another OSG Studio; "
                "end that one, or choose another folder with --data-dir"
            )
        return self

    def __exit__(self, *_: object) -> None:
        self._close()

    def _acquire(self) -> bool:
        if os.name != "posix":
            return True
        import fcntl

        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True

    def _close(self) -> None:
        os.close(self._descriptor)
        self._descriptor = -1
