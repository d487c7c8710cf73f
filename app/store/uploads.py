"""Store of unfinished uploads: the bytes so far survive lost connections and restarts."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from itertools import chain
from pathlib import Path
from types import MappingProxyType

from app.recognition.text.atomic_files import sync_directory, write_atomically
from app.store.database import NotFound
from app.store.models import OWN_ID, new_id, now

ACTIVE = timedelta(hours=1)
"""Time after its newest byte for which an upload counts as active: longer than a dropped connection
or a restart lasts, but short enough that abandoned uploads do not keep disk space reserved."""

KEPT = timedelta(days=1)
"""Time after its newest byte for which an upload is kept, and counts towards its owner's quota."""


@dataclass(frozen=True)
class Upload:
    """A file that is being received.

    Attributes
    ----------
    id
        Id of the upload; the later clip keeps it as its idempotency key.
    name
        File name given by the sender.
    size
        Bytes of the whole file.
    path
        File of the bytes received so far.
    fields
        Values from the sender beside the bytes, by name.
    client
        Address of the sender.
    owner
        Name of the sender's token.

    """

    id: str
    name: str
    size: int
    path: Path
    fields: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    client: str = ""
    owner: str = ""

    @property
    def offset(self) -> int:
        """Number of bytes received."""
        return self.path.stat().st_size

    @property
    def room(self) -> int:
        """Number of bytes that it takes at most: chapters are joined beside what was received."""
        return room_of(self.size, joined=bool(self.fields.get("chapters")))

    @property
    def to_come(self) -> int:
        """Number of bytes that it may still take; none if the upload has ended meanwhile."""
        try:
            return max(self.room - self.offset, 0)
        except FileNotFoundError:
            return 0


def room_of(size: int, *, joined: bool) -> int:
    """Return how many bytes a received file takes until its clip stands, if it must be joined."""
    return 2 * size if joined else size


class UploadStore:
    """Keeps uploads.

    Parameters
    ----------
    folder
        Folder of the files: ``<id>`` with the bytes and ``<id>.json`` with their description. It is
        on the same file system as the clips, so that a finished file is renamed and not copied.

    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def create(
        self,
        name: str,
        size: int,
        fields: Mapping[str, str] | None = None,
        client: str = "",
        owner: str = "",
    ) -> Upload:
        """Begin an upload of `size` bytes, with the values from its sender."""
        upload_id, given = new_id(), dict(fields or {})
        about = {"name": name, "size": size, "fields": given, "client": client, "owner": owner}
        path = self._folder / upload_id
        try:
            write_atomically(self._about(upload_id), json.dumps(about).encode())
            path.touch()
            sync_directory(self._folder)
        except OSError:
            self.remove(upload_id)
            raise
        return Upload(upload_id, name, size, path, given, client, owner)

    def active(self) -> list[Upload]:
        """Return the uploads that got bytes, or were begun, within the last `ACTIVE`."""
        since, found = now() - ACTIVE, []
        for about in self._folder.glob("*.json"):
            with suppress(NotFound, FileNotFoundError):  # It may end meanwhile.
                upload = self.get(about.stem)
                if _modification_time(upload.path) >= since:
                    found.append(upload)
        return found

    def get(self, upload_id: str) -> Upload:
        """Return an upload that is not finished.

        Raises
        ------
        NotFound
            When there is none.

        """
        path = self._folder / upload_id
        # Only our own ids become paths.
        if not OWN_ID.fullmatch(upload_id) or not path.is_file():
            raise NotFound(f"there is no upload {upload_id[:80]!r}; begin it anew")
        # An upload that an earlier version began has no fields, client or owner.
        return Upload(id=upload_id, path=path, **json.loads(self._about(upload_id).read_text()))

    def remove(self, upload_id: str) -> None:
        """Remove an upload and its bytes; do nothing if there is none."""
        _remove(self._folder / upload_id)
        _remove(self._about(upload_id))

    def purge(self, before: datetime) -> int:
        """Remove uploads that got no bytes since `before`; return the number removed.

        What a crash left of a description goes too: with its upload, or by its own age.
        """
        found: dict[str, list[Path]] = {}
        for path in self._folder.iterdir():
            # ``<id>``, ``<id>.json``, or ``.<id>.json.*.part``, which is still being written.
            found.setdefault(path.name.removeprefix(".").partition(".")[0], []).append(path)
        stale = [paths for paths in found.values() if max(map(_modification_time, paths)) < before]
        for path in chain.from_iterable(stale):
            _remove(path)
        return len(stale)

    def _about(self, upload_id: str) -> Path:
        return self._folder / f"{upload_id}.json"


def _remove(path: Path) -> None:
    if path.is_dir():  # Left over from a crash during a probe.
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _modification_time(path: Path) -> datetime:
    with suppress(OSError):
        return datetime.fromtimestamp(path.stat().st_mtime, UTC)
    return datetime.now(UTC)
