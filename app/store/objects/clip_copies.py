"""Clip cache: local copies of clip files, limited in size when an object store holds all."""

from __future__ import annotations

import logging
import os
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock, Thread
from time import time

from app.store.database import StoreError
from app.store.objects.object_store import ObjectStore

RECENT_SECONDS = 600.0
"""Seconds after its last use before a copy may be removed; who got its path has opened it by
then."""

LEFT_SHARE = 0.9
"""Share of the limit to which copies are reduced; each reduction searches the whole folder."""

AT_ONCE = 500
"""Clips whose jobs are looked up in one query."""

logger = logging.getLogger(__name__)


class ClipCopies:
    """Removes the least recently used copies when all copies together are too large.

    A copy is removed only if the object store has a file of that name and size, its clip has no
    waiting or running job, nobody holds it, and it was not used recently. A copy's access time is
    the time of its last use, also in an earlier run of the server.

    Parameters
    ----------
    folder
        Folder of the copies: ``<folder>/<clip id>/<file>``.
    objects
        Object store of the originals.
    limit
        Most bytes of all copies together; 0 is no limit.
    at_rest
        Returns those of the given clips that have a row, and no waiting or running job.

    """

    def __init__(
        self,
        folder: Path,
        objects: ObjectStore,
        limit: int,
        at_rest: Callable[[Collection[str]], set[str]],
    ) -> None:
        self._folder = folder
        self._objects = objects
        self._limit = limit
        self._at_rest = at_rest
        self._size: int | None = None
        self._held: Counter[Path] = Counter()
        # A copy must not be used between the check of its last use and its removal.
        self._using = Lock()
        self._making_room = Lock()

    def use(self, file: Path) -> bool:
        """Record that a file is used now; return whether it exists."""
        if not self._limit:
            return file.is_file()
        with self._using:
            try:
                changed = file.stat().st_mtime_ns
                os.utime(file, ns=(round(time() * 1e9), changed))
            except OSError:
                return False
        return True

    @contextmanager
    def hold(self, files: Collection[Path]) -> Iterator[None]:
        """Keep copies while the context is open, for a process that opens them later."""
        with self._using:
            self._held.update(files)
        try:
            yield
        finally:
            with self._using:
                self._held.subtract(files)
                self._held = +self._held
            for file in files:
                self.use(file)

    def add(self, file: Path) -> None:
        """Count a new copy; if all are too large now, make room in another thread."""
        if not self._limit:
            return
        if self._size is not None:
            with suppress(OSError):
                self._size += file.stat().st_size
        if self._size is None or self._size > self._limit:
            Thread(target=self.make_room, daemon=True, name="copies of clips").start()

    def make_room(self) -> int:
        """Remove copies until they are within the limit; return the number removed."""
        if not self._limit or not self._making_room.acquire(blocking=False):
            return 0
        try:
            return self._make_room()
        except StoreError as error:
            logger.warning("copies of clips stay for now: %s", error)
            return 0
        finally:
            self._making_room.release()

    def _make_room(self) -> int:
        copies = sorted(self._list(), key=lambda copy: copy[1].st_atime_ns)
        self._size = sum(status.st_size for _, status in copies)
        if self._size <= self._limit:
            return 0
        removed = 0
        for start in range(0, len(copies), AT_ONCE):
            some = copies[start : start + AT_ONCE]
            resting = self._at_rest({path.parent.name for path, _ in some})
            for path, status in some:
                if self._size <= LEFT_SHARE * self._limit:
                    return removed
                if path.parent.name in resting and self._remove(path, status):
                    self._size -= status.st_size
                    removed += 1
        logger.info("copies of clips take %d bytes, and %d are allowed", self._size, self._limit)
        return removed

    def _list(self) -> Iterator[tuple[Path, os.stat_result]]:
        for path in self._folder.glob("*/*"):
            with suppress(OSError):
                if path.is_file() and not path.name.startswith("."):
                    yield path, path.stat()

    def _remove(self, path: Path, seen: os.stat_result) -> bool:
        """Remove a copy, unless it is in use or the only one."""
        if self._objects.size(f"{path.parent.name}/{path.name}") != seen.st_size:
            return False
        with self._using, suppress(OSError):
            now = path.stat()
            recent = time() - now.st_atime < RECENT_SECONDS
            changed = (now.st_mtime_ns, now.st_size) != (seen.st_mtime_ns, seen.st_size)
            if not (recent or changed or path in self._held):
                path.unlink()  # A reader that has it open can read on.
                return True
        return False
