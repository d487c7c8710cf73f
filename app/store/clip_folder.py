"""Clip folder: the clips' files on this machine, written through to an object store."""

from __future__ import annotations

import logging
import shutil
from collections.abc import Iterable
from pathlib import Path
from threading import Lock
from weakref import WeakValueDictionary

from app.store.atomic_files import PARTIAL_SUFFIX, publish
from app.store.database import NotFound, StoreUnavailable
from app.store.models import OWN_ID, new_id
from app.store.objects import ObjectStore
from app.store.objects.clip_copies import ClipCopies

logger = logging.getLogger(__name__)


class ClipFolder:
    """Finds and keeps the files of clips; each clip has a folder named by its id.

    A complete file is in the object store before the database refers to it. The folder of a clip
    without a row records that the object store may still have files of that clip.

    Parameters
    ----------
    path
        The folder on this machine.
    objects
        Object store that keeps the files for all servers.
    copies
        Removes copies from the folder when these are too large together.

    """

    def __init__(self, path: Path, objects: ObjectStore, copies: ClipCopies) -> None:
        self.path = path
        self._objects = objects
        self._copies = copies
        self._fetching: WeakValueDictionary[Path, Lock] = WeakValueDictionary()
        self._choosing = Lock()
        path.mkdir(parents=True, exist_ok=True)

    def home(self, clip_id: str) -> Path:
        """Return the folder of a clip's files, which need not exist.

        Raises
        ------
        NotFound
            When the id is none of ours, and might lead out of the folder.

        """
        if not OWN_ID.fullmatch(clip_id):
            raise NotFound(f"there is no clip {clip_id[:80]!r}")
        return self.path / clip_id

    def find(self, clip_id: str, name: str) -> Path:
        """Return the path of a file, fetched if it is not on this machine; it may not exist.

        Raises
        ------
        StoreUnavailable
            When the file is not on this machine and the object store does not answer.

        """
        target = self.home(clip_id) / name
        if self._copies.use(target):
            return target
        with self._choosing:
            fetching = self._fetching.setdefault(target, Lock())
        with fetching:
            if not self._copies.use(target):
                self._fetch(target, f"{clip_id}/{name}")
        return target

    def keep(self, clip_id: str, names: Iterable[str]) -> None:
        """Put those of the named files that exist into the object store; they must be complete.

        Raises
        ------
        StoreUnavailable
            When not all files are stored; the call can be repeated.

        """
        for name in names:
            if (file := self.home(clip_id) / name).is_file():
                self._objects.upload(file, f"{clip_id}/{name}")
                self._copies.add(file)

    def note(self, clip_id: str) -> None:
        """Record that a clip's files are to be removed, in case the removal is interrupted."""
        if OWN_ID.fullmatch(clip_id):
            self.home(clip_id).mkdir(exist_ok=True)

    def remove(self, clip_ids: Iterable[str]) -> int:
        """Remove all files of clips; return the number of clips.

        A name that leads out of the folder is left alone. Other names than ids are of folders that
        a crash has left here, and not in the object store.
        When the object store does not answer, the folders of the remaining clips stay, so that
        `ClipStore.sweep` removes their files later.
        """
        removed = 0
        try:
            for clip_id in clip_ids:
                if OWN_ID.fullmatch(clip_id):
                    self._objects.remove(clip_id)
                elif (self.path / clip_id).parent != self.path or clip_id in ("", "..", "."):
                    logger.error("nothing is removed for %r, which is no clip", clip_id[:80])
                    continue
                shutil.rmtree(self.path / clip_id, ignore_errors=True)
                removed += 1
        except StoreUnavailable as error:
            logger.warning("files of clips are removed at a later start: %s", error)
        return removed

    def _fetch(self, target: Path, name: str) -> None:
        target.parent.mkdir(exist_ok=True)
        partial = target.with_name(f"{target.name}.{new_id()}{PARTIAL_SUFFIX}")
        try:
            if self._objects.download(name, partial):
                publish(partial, target)
                self._copies.add(target)
        finally:
            partial.unlink(missing_ok=True)
