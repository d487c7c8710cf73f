"""Job runner: runs jobs of all kinds, knows their progress, cancels them."""

from __future__ import annotations

import asyncio
import logging
import re
import time
from dataclasses import dataclass
from typing import Any, TypeVar

from app.api.events.broadcast import Broadcast
from app.api.jobs.job import Job, JobCancelled, Progress
from app.api.observation.logs import FIELDS, job_id
from app.api.observation.metrics import Metrics
from app.api.workers.worker_messages import Failed

Result = TypeVar("Result")

logger = logging.getLogger(__name__)


@dataclass(eq=False)
class _Run:
    """One execution of a job."""

    job: Job[Any]
    broadcast: Broadcast
    progress: Progress | None = None
    cancelled: bool = False
    waiting: int = 0

    def report(self, progress: Progress) -> None:
        if self.cancelled:
            raise JobCancelled
        self.progress = progress
        self.broadcast.send(self.job.event(progress))


class JobRunner:
    """Runs jobs on the event loop that created it.

    Parameters
    ----------
    broadcast
        Publishes every step as an event.
    metrics
        Measures the duration of jobs.

    """

    def __init__(self, broadcast: Broadcast, metrics: Metrics | None = None) -> None:
        self._broadcast = broadcast
        self._metrics = metrics or Metrics()
        self._runs: dict[str, tuple[_Run, asyncio.Task[Any]]] = {}
        self._elsewhere: dict[str, Progress] = {}
        self._closed = False

    async def run(self, job: Job[Result]) -> Result:
        """Run a job, or wait for the running one of the same key, and return its result.

        The job goes on when a caller is cancelled while others wait. When the last caller is
        cancelled, the job ends, unless it is resumable.

        Raises
        ------
        JobCancelled
            When somebody cancels the job, or the server stops.

        """
        if job.key not in self._runs:
            self._start(job)
        run: _Run = self._runs[job.key][0]
        task: asyncio.Task[Result] = self._runs[job.key][1]
        run.waiting += 1
        try:
            # Not awaited directly: cancelling the job must not look like cancelling the caller.
            await asyncio.wait([task])
        finally:
            run.waiting -= 1
            if not (run.waiting or task.done() or job.resumable):
                await self.cancel(job.key)
        if task.cancelled():
            raise JobCancelled
        return task.result()

    def progress(self, key: str) -> Progress | None:
        """Return the progress of a job, here or on another server; None if it is not running."""
        if key in self._runs:
            return self._runs[key][0].progress
        return self._elsewhere.get(key)

    def note(self, key: str, progress: Progress | None) -> None:
        """Store the progress of another server's job; None if it is no longer running there."""
        if progress is None:
            self._elsewhere.pop(key, None)
        else:
            self._elsewhere[key] = progress

    async def cancel(self, key: str) -> bool:
        """Cancel a job; return whether it ran. A job of the same key may begin at once."""
        if key not in self._runs:
            return False
        run, task = self._runs.pop(key)
        run.cancelled = True
        task.cancel()
        await asyncio.wait([task])
        return True

    async def stop(self) -> None:
        """Cancel the jobs that are not resumable, and refuse new ones."""
        self._closed = True
        for key in [key for key, (run, _) in self._runs.items() if not run.job.resumable]:
            await self.cancel(key)

    def _start(self, job: Job[Any]) -> None:
        if self._closed and not job.resumable:
            raise JobCancelled
        run = _Run(job, self._broadcast)
        task = asyncio.create_task(self._observe(job, run))
        self._runs[job.key] = run, task
        task.add_done_callback(lambda _: self._end(run))

    async def _observe(self, job: Job[Result], run: _Run) -> Result:
        """Run a job; log and measure how it ends."""
        kind = re.sub(r"(?<!^)(?=[A-Z])", "_", type(job).__name__.removesuffix("Job")).lower()
        job_id.set(job.key)
        began, outcome = time.monotonic(), "failed"
        try:
            result = await job.run(run.report)
            outcome = "failed" if isinstance(result, Failed) else "done"
            return result
        except (asyncio.CancelledError, JobCancelled):
            outcome = "cancelled"
            raise
        finally:
            seconds = time.monotonic() - began
            self._metrics.jobs.labels(kind, outcome).observe(seconds)
            fields = {"kind": kind, "outcome": outcome, "seconds": round(seconds, 3)}
            logger.info("job ended", extra={FIELDS: fields})

    def _end(self, run: _Run) -> None:
        if run.job.key in self._runs and self._runs[run.job.key][0] is run:
            del self._runs[run.job.key]
