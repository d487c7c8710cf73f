"""Data folder: the lock that keeps a second server off it, and the id of its server.

A second server would remove the first's uploads. The id survives restarts, so that a server knows
the jobs that it ran before.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final, Self

from filelock import FileLock, Timeout

from app.recognition.text.atomic_files import write_atomically
from app.store.database import StoreUnavailable
from app.store.models import OWN_ID, new_id

FILE: Final = "server"
"""Name of the file with the server's id, which one server at a time uses."""


class FolderLock:
    """Lock of a folder while the context is open; the system releases it when the process ends.

    Parameters
    ----------
    folder
        Folder to lock; created if missing.
    remedy
        What to do when another process holds it.

    Raises
    ------
    StoreUnavailable
        On entering, when another process holds it or the folder cannot be written to.

    """

    def __init__(
        self,
        folder: Path,
        remedy: str = "end that one, or choose another folder with --data-dir",
    ) -> None:
        self._folder = folder
        self._remedy = remedy
        self._lock = FileLock(folder / "lock", mode=0o600)

    def __enter__(self) -> Self:
        try:
            # The folder holds recordings of people, which are private to this user.
            self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            self._lock.acquire(blocking=False)
        except Timeout as error:
            raise StoreUnavailable(
                f"the data folder {self._folder} is in use by another OSG Studio; {self._remedy}"
            ) from error
        except OSError as error:
            raise StoreUnavailable(
                f"the data folder {self._folder} cannot be written to ({error.strerror}); "
                "choose another one with --data-dir"
            ) from error
        return self

    def __exit__(self, *_: object) -> None:
        self._lock.release()


def identity_of(folder: Path) -> str:
    """Return the id of a data folder's server, created at its first start."""
    path = folder / FILE
    if path.is_file() and OWN_ID.fullmatch(known := path.read_text("ascii", "replace")):
        return known
    made = new_id()
    write_atomically(path, made.encode())
    return made
