"""Task folders: copies of the server's files on another machine, for one process.

Where the clips are in an object store, the machines of a cluster share no folder with the server. A
task then creates its own folder, copies the input files of its process into it, runs the process
there as if it were the server's folder, and returns the output files to the server.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Final

from app.api.workers.executor import TaskFiles
from app.store.atomic_files import PARTIAL_SUFFIX
from app.store.errors import StoreUnavailable
from app.store.models import new_id
from app.store.objects import open_object_store

_CLIP_FILE: Final = re.compile(r"[0-9a-f]{32}/[a-z]{1,16}(\.[a-z]{1,5})?")
"""Name of a clip's file in an object store."""

Contents = dict[str, bytes]
"""Files by their paths under the server's folder, with ``/`` between."""


@dataclass(frozen=True)
class Workspace:
    """Description of a task's own folder, which is sent to another machine.

    Attributes
    ----------
    root
        The server's folder, which the task's folder replaces.
    storage
        Address of the object store.
    fetched
        Names, by path, of the files that the task fetches from the object store.
    sent
        Contents of the other files that its process reads.
    outputs
        Paths of the files and folders that the process writes.

    """

    root: str
    storage: str
    fetched: dict[str, str]
    sent: Contents
    outputs: tuple[str, ...]

    def prepare(self, folder: Path, arguments: Sequence[str]) -> list[str]:
        """Fill the task's folder; return the arguments of the process that works there.

        Raises
        ------
        StoreUnavailable
            When the object store does not answer, or has no such file.

        """
        there = str(folder)
        objects = open_object_store(self.storage)
        for path, name in self.fetched.items():
            target = _made(folder, path)
            if not objects.download(name, target):
                raise StoreUnavailable(f"{self.storage} holds no {name}")
        for path, content in self.sent.items():
            _made(folder, path).write_bytes(content.replace(_quoted(self.root), _quoted(there)))
        for path in self.outputs:
            _made(folder, path)
        changed = [argument.replace(self.root, there) for argument in arguments]
        for argument in changed:
            if argument.startswith("--scratch="):
                Path(argument.partition("=")[2]).mkdir(parents=True, exist_ok=True)
        return changed


class Written:
    """The files that a process has written into the folder of its task.

    Parameters
    ----------
    folder
        The task's folder.
    workspace
        Describes the output paths.

    """

    def __init__(self, folder: Path, workspace: Workspace) -> None:
        self._folder = folder
        self._outputs = [folder / path for path in workspace.outputs]
        self._given: dict[Path, tuple[int, int]] = {}

    def take(self, most: int | None = None) -> Iterator[tuple[str, bytes]]:
        """Yield files that are new or changed since the last call, of at most `most` bytes."""
        for path in self._list():
            status = path.stat()
            state = status.st_mtime_ns, status.st_size
            if self._given.get(path) == state or (most is not None and status.st_size > most):
                continue
            self._given[path] = state
            yield PurePosixPath(path.relative_to(self._folder)).as_posix(), path.read_bytes()

    def _list(self) -> Iterator[Path]:
        for path in self._outputs:
            if path.is_dir():
                yield from sorted(each for each in path.iterdir() if each.is_file())
            elif path.is_file():
                yield path


class OwnFolders:
    """Folders of a server that no other machine sees.

    Parameters
    ----------
    root
        Its data folder.
    clips
        The folder of its copies of clips, in `root`.
    storage
        Address of the object store that has the clips' files.

    """

    def __init__(self, root: Path, clips: Path, storage: str) -> None:
        self._root = root
        self._clips = clips
        self._storage = storage

    def describe(self, files: TaskFiles) -> Workspace:
        """Return the workspace of a task with these files; read the files to be sent."""
        fetched: dict[str, str] = {}
        sent: Contents = {}
        for path in files.inputs:
            if (kept := self._name(path)) is not None:
                fetched[self._relative(path)] = kept
            else:
                sent[self._relative(path)] = path.read_bytes()
        outputs = tuple(self._relative(path) for path in files.outputs)
        for name, place in zip(outputs, files.outputs, strict=True):
            if place.is_dir():
                # An empty file, so that the output folders exist for the process.
                sent[f"{name}/.folder"] = b""
        return Workspace(str(self._root), self._storage, fetched, sent, outputs)

    def put(self, path: str, content: bytes) -> None:
        """Write a file that a task returned, in place of an earlier one."""
        target = self._root / path
        if not target.parent.is_dir():
            return  # The clip or the waiting request is gone.
        partial = target.with_name(f".{target.name}.{new_id()}{PARTIAL_SUFFIX}")
        try:
            partial.write_bytes(content)
            partial.replace(target)
        finally:
            partial.unlink(missing_ok=True)

    def _relative(self, path: Path) -> str:
        return PurePosixPath(path.relative_to(self._root)).as_posix()

    def _name(self, path: Path) -> str | None:
        """Return the name of a clip's file in the object store; None for other files."""
        if not path.is_relative_to(self._clips):
            return None
        name = PurePosixPath(path.relative_to(self._clips)).as_posix()
        return name if _CLIP_FILE.fullmatch(name) else None


def _made(folder: Path, path: str) -> Path:
    """Return a path under a folder, and create its parent folder."""
    target = folder / path
    target.parent.mkdir(parents=True, exist_ok=True)
    return target


def _quoted(path: str) -> bytes:
    """Return a path as it is written in a JSON document."""
    return json.dumps(path, ensure_ascii=False)[1:-1].encode()
