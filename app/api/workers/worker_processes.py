"""Workers: runs each task in a process of its own, in its turn, by an executor."""

from __future__ import annotations

import asyncio
import logging
import tempfile
from collections.abc import Awaitable, Callable, Collection
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Final

from app.api.observation.metrics import Metrics
from app.api.workers.executor import Executor, ExecutorLost, Lines, Order
from app.api.workers.local_processes import LocalProcesses
from app.api.workers.task import failure_of
from app.api.workers.tasks import AnyTask, Probe
from app.api.workers.worker_messages import (
    LAST,
    MORE,
    Answered,
    Failed,
    Finished,
    Message,
    Probed,
    Progressed,
    parse,
)
from app.clip_sources import ClipSource, ReadOptions
from app.settings import DASK, Settings

MOST_AT_ONCE: Final = {"short": 2, "long": 2}
"""Most tasks of a queue at the same time; further ones wait. A hundred uploads must not start a
hundred processes that probe them, nor health checks and test runs take all cores."""

MOST_MESSAGE_BYTES = 256 * 1024 * 1024
"""Longest message: an imported language of a thousand gestures has 27 million characters."""

RETRY_SECONDS = 2.0
"""Wait in seconds before a task whose executor was lost is repeated."""

Hear = Callable[[Progressed | Answered], Awaitable[None]]

logger = logging.getLogger(__name__)


def _hold_nothing(_files: Collection[Path]) -> AbstractContextManager[None]:
    return nullcontext()


class Workers:
    """Starts worker processes with the limits of the settings, by the executor of the settings.

    Parameters
    ----------
    settings
        Limits of memory, time and file size.
    metrics
        Counts the processes that are ended because they report no progress.
    hold
        Keeps files on this machine for processes that wait for their turn.

    """

    def __init__(
        self,
        settings: Settings,
        metrics: Metrics | None = None,
        hold: Callable[[Collection[Path]], AbstractContextManager[None]] = _hold_nothing,
    ) -> None:
        self._settings = settings
        self._metrics = metrics or Metrics()
        self._hold = hold
        self._here = LocalProcesses(settings.limits.worker_memory_bytes * settings.workers)
        self._executor = _executor_of(settings, self._here)
        self._turns = {queue: asyncio.Semaphore(most) for queue, most in MOST_AT_ONCE.items()}

    async def close(self) -> None:
        """Release the connections to other machines."""
        await self._executor.close()

    async def probe(self, source: ClipSource, file: Path, options: ReadOptions) -> Probed | Failed:
        """Probe a received file."""
        task = Probe(
            source=source.name,
            file=file,
            options=options,
            silence_seconds=source.probe_seconds,
            broken_off=failure_of(source.broken_off),
        )
        ended = await self._run(task)
        return task.broken_off if isinstance(ended, Finished) else ended

    async def run(self, task: AnyTask, hear: Hear | None = None) -> Finished | Failed:
        """Run a task in its turn; call `hear` with its progress and answers; return its outcome."""
        ended = await self._run(task, hear)
        return task.broken_off if isinstance(ended, Probed) else ended

    async def _run(self, task: AnyTask, hear: Hear | None = None) -> Probed | Finished | Failed:
        turn = nullcontext() if task.queue is None else self._turns[task.queue]
        with self._hold(task.files.inputs):
            async with turn:
                for _ in range(task.tries):
                    if (ended := await self._try(task, hear)) is not None:
                        return ended
        return task.broken_off

    async def _try(self, task: AnyTask, hear: Hear | None) -> Probed | Finished | Failed | None:
        """Run a task in one process, again if the executor is lost; return None if it dies."""
        executor = self._here if task.here else self._executor
        limits = self._settings.limits
        silence = task.silence_seconds or limits.worker_silence_seconds
        files = task.files
        folder = files.outputs[0].parent if files.outputs else self._settings.clips
        while True:
            # On the clip's disk, and removed at the next start if the server is killed.
            with tempfile.TemporaryDirectory(prefix=".unpacked-", dir=folder) as scratch:
                order = Order(
                    task=task.model_dump_json(),
                    files=files,
                    scratch=Path(scratch),
                    memory_bytes=limits.worker_memory_bytes,
                    cpu_seconds=task.cpu_seconds or limits.worker_cpu_seconds,
                    file_bytes=limits.worker_file_bytes,
                )
                try:
                    async with executor.start(order) as lines:
                        while message := await _next_message(lines, silence):
                            if not isinstance(message, Progressed | Answered):
                                return message
                            if hear is not None:
                                await hear(message)
                    return None
                except TimeoutError:
                    self._metrics.stalls.inc()
                    return task.hung or task.broken_off
                except ExecutorLost as error:
                    logger.warning("a job is run again: %s", error)
            await asyncio.sleep(RETRY_SECONDS)


async def _next_message(lines: Lines, silence_seconds: float) -> Message | None:
    """Return the next message of a process; None at its end, also if the last one is torn."""
    parts, length = [], 0
    while length < MOST_MESSAGE_BYTES:
        try:
            line = await lines.readline(silence_seconds)
            if line.startswith(MORE):
                parts.append(line[len(MORE) :].rstrip(b"\n"))
                length += len(line)
            elif line.startswith(LAST):
                parts.append(line[len(LAST) :])
                return await asyncio.to_thread(lambda: parse(b"".join(parts)))
            else:
                return parse(line) if line else None
        except ValueError:
            return None  # Torn by a crash, or longer than any of ours.
    return None


def _executor_of(settings: Settings, here: LocalProcesses) -> Executor:
    if settings.executor is None:
        return here
    from app.api.workers.dask_cluster import DaskCluster, OwnFolder

    own = None
    if settings.objects is not None:
        own = OwnFolder(settings.data_dir, settings.clips, settings.objects)
    return DaskCluster(settings.executor.removeprefix(DASK), own)
