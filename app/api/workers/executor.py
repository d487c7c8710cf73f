"""Executor: where the worker processes of jobs run, on this machine or on others."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Protocol

COMMAND: Final = ("-m", "app.api.workers")
"""Arguments of Python that start a worker process."""

PACKAGE_PARENT: Final = Path(__file__).resolve().parents[3]


class ExecutorLost(Exception):
    """Raised when the outcome of a process cannot be known any more; it may be started again.

    A restart is safe: a worker depends only on its files and arguments, and writes each file at
    once.
    """


class Lines(Protocol):
    """Protocol of the lines that a process writes."""

    async def readline(self, silence_seconds: float | None = None) -> bytes:
        """Return the next line; empty at the end of the process.

        Raises
        ------
        TimeoutError
            When the process has run for that time without a line; the time that it waits for a
            place does not count.
        ExecutorLost
            When the connection to the process is lost.

        """
        ...


@dataclass(frozen=True)
class TaskFiles:
    """The files that a worker process reads and writes.

    Attributes
    ----------
    inputs
        Files that it reads.
    outputs
        Files that it writes, or folders of files.

    """

    inputs: tuple[Path, ...]
    outputs: tuple[Path, ...]


class Executor(Protocol):
    """Protocol of executors, which run worker processes."""

    def start(
        self, arguments: Sequence[str], files: TaskFiles
    ) -> AbstractAsyncContextManager[Lines]:
        """Run a worker process with these arguments; it is ended at the end of the context.

        The context begins when the process does, which may have to wait for a place. Files that the
        process has written are here before the line that reports them.

        Raises
        ------
        ExecutorLost
            On entering, when no process can be started now.

        """
        ...

    async def close(self) -> None:
        """Release all resources."""
        ...
