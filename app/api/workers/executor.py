"""Executor: where the worker processes of jobs run, on this machine or on others."""

from __future__ import annotations

from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Protocol

COMMAND: Final = ("-m", "app.api.workers")
"""Arguments of Python that start a worker process, which reads its order from stdin."""

PACKAGE_PARENT: Final = Path(__file__).resolve().parents[3]


class ExecutorLost(Exception):
    """Raised when the outcome of a process cannot be known any more; it may be started again.

    A restart is safe: a task depends only on its fields and files, and writes each file at once.
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


@dataclass(frozen=True)
class TaskFiles:
    """The files that a task reads and writes."""

    inputs: tuple[Path, ...] = ()
    outputs: tuple[Path, ...] = ()


@dataclass(frozen=True)
class Order:
    """A task for a process; without its class, because Dask loads this into its scheduler too.

    Attributes
    ----------
    task
        A `Task` as JSON.
    files
        Its files.
    scratch
        Empty folder into which it may unpack archives.
    memory_bytes, cpu_seconds, file_bytes
        Its limits; 0 for none.

    """

    task: str
    files: TaskFiles
    scratch: Path
    memory_bytes: int = 0
    cpu_seconds: int = 0
    file_bytes: int = 0


class Executor(Protocol):
    """Protocol of executors, which run worker processes."""

    def start(self, order: Order) -> AbstractAsyncContextManager[Lines]:
        """Run a task in a process, which is ended at the end of the context.

        The context begins when the process does, which may have to wait for a place. Files that the
        process has written are here before the line that reports them.

        Raises
        ------
        ExecutorLost
            On entering, when no process can be started now.

        """

    async def close(self) -> None:
        """Release all resources."""
