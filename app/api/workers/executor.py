"""Executor: where the worker processes of jobs run, on this machine or on others."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Protocol

COMMAND: Final = ("-m", "app.api.workers.worker")
"""Arguments of Python that start a worker process."""

PACKAGE_PARENT: Final = Path(__file__).resolve().parents[3]


class ExecutorLost(Exception):
    """Raised when it is not known any more what became of a process; it may be started again.

    A worker's command is a function of its files and arguments alone, and writes each file at once.
    """


class Lines(Protocol):
    """The lines that a process writes."""

    async def readline(self) -> bytes:
        """Return the next line; empty at the end of the process.

        Raises
        ------
        ExecutorLost
            When the process cannot be heard any more.

        """
        ...


@dataclass(frozen=True)
class TaskFiles:
    """The files that a worker process reads and writes.

    Attributes
    ----------
    inputs
        What it reads.
    outputs
        What it writes: files, or folders of files.

    """

    inputs: tuple[Path, ...]
    outputs: tuple[Path, ...]


class Executor(Protocol):
    """Runs worker processes."""

    def start(
        self, arguments: Sequence[str], files: TaskFiles
    ) -> AbstractAsyncContextManager[Lines]:
        """Run a worker process with these arguments; it is ended at the end of the context.

        The context begins when the process does, which may have to wait for a place. What the
        process has written is in the files here before the line is heard that says so.

        Raises
        ------
        ExecutorLost
            On entering, when no process can be started now.

        """
        ...

    async def close(self) -> None:
        """Release what was opened."""
        ...
