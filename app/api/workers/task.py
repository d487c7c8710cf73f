"""Task: the work of a worker process, with its files, its limits and its words for failure."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, ClassVar, Literal

from pydantic import BaseModel, ConfigDict

from app.api.workers.executor import TaskFiles
from app.api.workers.worker_messages import Failed, Message
from app.clip_sources import Refusal
from app.recognition.errors import LanguageError, ModelError

Report = Callable[[Message], None]

READS, WRITES = "reads", "writes"

Reads = Annotated[Path, READS]
"""Field of a task: a file that it reads, or for the command line a folder."""

Writes = Annotated[Path, WRITES]
"""Field of a task: a file that it writes, in a folder that it may write into."""


class Task(BaseModel, ABC):
    """Work that a process of its own does, because what it reads may crash it or take it over.

    It depends on its fields and files only, and writes each file at once, so that it can be
    repeated, on any machine.

    Attributes
    ----------
    queue
        The tasks with which it waits for its turn; None for those that are queued elsewhere.
    here
        Whether it runs on the server's machine in any case.
    tries
        Processes that may die until it has failed.
    cpu_seconds
        Most processor time; None for that of the settings.
    unusable
        Code of an error that has no code of its own.
    kind
        Name of its processes, after ``osg``.
    silence_seconds
        Most seconds between two messages; None for those of the settings.
    broken_off
        The failure of a process that died, or needs more memory than it may use.
    hung
        The failure of a process that was silent for too long; None for `broken_off`.

    """

    model_config = ConfigDict(frozen=True)

    queue: ClassVar[Literal["short", "long"] | None] = None
    here: ClassVar[bool] = False
    tries: ClassVar[int] = 1
    cpu_seconds: ClassVar[int | None] = None
    unusable: ClassVar[str] = "language_invalid"

    kind: str
    silence_seconds: float | None = None
    broken_off: Failed
    hung: Failed | None = None

    @property
    def files(self) -> TaskFiles:
        """The files that it reads and writes."""
        marked: dict[str, list[Path]] = {READS: [], WRITES: []}
        for name, field in type(self).model_fields.items():
            if field.metadata and (path := getattr(self, name)) is not None:
                marked[field.metadata[0]].append(path)
        return TaskFiles(tuple(marked[READS]), tuple(marked[WRITES]))

    @abstractmethod
    def run(self, report: Report) -> None:
        """Do the work in this process, and report how far it is; the last report is its outcome."""

    def refuse(self, error: Exception) -> Failed:
        """Return the failure for an error of `run`."""
        match error:
            case MemoryError():
                return self.broken_off
            case ModelError():
                return Failed(code="model_missing", detail=str(error))
            case LanguageError(pointer=pointer):
                return Failed(code="language_invalid", detail=str(error), pointer=pointer)
            case OSError(strerror=reason):
                detail = f"the server's storage cannot be used ({reason}); free space and retry"
                return Failed(code="storage_unavailable", detail=detail)
        return Failed(code=self.unusable, detail=str(error))


def failure_of(refusal: Refusal) -> Failed:
    """Return a source's refusal as the outcome of a task."""
    return Failed(code=refusal.code, detail=refusal.detail)
