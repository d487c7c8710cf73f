"""Local processes: the executor that runs worker processes on this machine."""

from __future__ import annotations

import asyncio
import contextlib
import sys
from asyncio.subprocess import PIPE
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from typing import Self

from app.api.workers.executor import COMMAND, PACKAGE_PARENT, Lines, TaskFiles
from app.api.workers.forked_worker import ForkedWorker, can_fork
from app.api.workers.rights import environment_of_workers, rights_to, rights_to_models
from app.recognition.models.storage import models_dir


class LocalProcesses:
    """Runs worker processes on this machine."""

    @asynccontextmanager
    async def start(self, arguments: Sequence[str], files: TaskFiles) -> AsyncIterator[Lines]:
        """Run a process; see `Executor`."""
        worker: ForkedWorker | _StartedWorker | None = None
        arguments = [*rights_to_models(models_dir()), *rights_to(files), *arguments]
        if can_fork():
            worker = await ForkedWorker.begin(arguments)
        if worker is None:
            worker = await _StartedWorker.begin(arguments)
        try:
            yield worker
        finally:
            await worker.end()

    async def close(self) -> None:
        """Do nothing: every process ends with its context."""


class _StartedWorker:
    """A running worker process that was started from the beginning."""

    def __init__(self, process: asyncio.subprocess.Process, lines: asyncio.StreamReader) -> None:
        self._process = process
        self._lines = lines

    @classmethod
    async def begin(cls, arguments: Sequence[str]) -> Self:
        """Begin a worker."""
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            *COMMAND,
            *arguments,
            stdin=PIPE,
            stdout=PIPE,
            cwd=PACKAGE_PARENT,
            env=environment_of_workers(),
            # Ctrl-C in the terminal is for the server, which then ends its workers in order.
            start_new_session=True,
        )
        assert process.stdout is not None
        return cls(process, process.stdout)

    async def readline(self, silence_seconds: float | None = None) -> bytes:
        """Return the next line; see `Lines`."""
        return await asyncio.wait_for(self._lines.readline(), silence_seconds)

    async def end(self) -> None:
        """End the process, and wait until it has ended."""
        with contextlib.suppress(ProcessLookupError):
            self._process.kill()
        await self._process.wait()
