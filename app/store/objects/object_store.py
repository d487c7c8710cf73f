"""Object store: keeps whole files by name, in a shared folder or in S3."""

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

    def download(self, name: str, target: Path) -> bool:
        """Write the file stored under `name` to `target`; return False if there is none.

        Raises
        ------
        StoreUnavailable
            When the store does not answer; `target` may then be incomplete.

        """

    def size(self, name: str) -> int | None:
        """Return the bytes of the file stored under `name`; None if there is none.

        Raises
        ------
        StoreUnavailable
            When the store does not answer.

        """

    def remove(self, clip_id: str) -> None:
        """Remove all files of a clip; do nothing if there are none.

        Raises
        ------
        StoreUnavailable
            When some files may be left.

        """


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


def open_object_store(address: str | None) -> ObjectStore:
    """Return the object store at ``s3://BUCKET/PREFIX``; without an address, the folder itself.

    Raises
    ------
    StoreUnavailable
        When the object store's settings in the environment cannot be used.

    """
    if address is None:
        return SharedFolder()
    # The S3 library is an extra, and takes a third of a second to load.
    from app.store.objects.s3 import S3Objects

    bucket, _, prefix = address.removeprefix("s3://").partition("/")
    return S3Objects(bucket, prefix.strip("/"))
