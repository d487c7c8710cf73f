"""Jobs: work that takes long, reports its progress and can be cancelled, mostly a worker's task."""

from __future__ import annotations

import asyncio
import logging
import time
from collections import OrderedDict
from collections.abc import Callable, Coroutine
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from starlette.concurrency import run_in_threadpool

from app.api.events.broadcast import Broadcast, Event
from app.api.observation.logs import FIELDS, job_id
from app.api.observation.metrics import Metrics
from app.api.workers.tasks import AnyTask
from app.api.workers.worker_messages import (
    Answered,
    Failed,
    Finished,
    Progress,
    Progressed,
    RecognizedTake,
)
from app.api.workers.worker_processes import Workers

LEAST_SHARE = 0.05
"""Share of the frames after which the rate is known; before, models load and caches fill."""

CACHED_RESULTS = 64
"""Results kept ready: a health report of twenty gestures is a hundred kilobytes of objects."""

_cached: OrderedDict[str, Any] = OrderedDict()

Result = TypeVar("Result")

logger = logging.getLogger(__name__)


class JobCancelled(Exception):
    """Raised to everybody who waits for a job that was cancelled."""


Report = Callable[[Progress], None]
"""Receives the progress, from any thread; raises `JobCancelled` when the job must end."""


@dataclass(frozen=True)
class Job(Generic[Result]):
    """One piece of work.

    Attributes
    ----------
    kind
        Its kind in logs and metrics.
    key
        Identity: a job whose key is already running waits for that run.
    event
        Returns the event to publish about a progress.
    run
        Does the work; cancelling its asyncio task or an exception of its argument ends it.
    resumable
        Whether the next start of the server runs it again, so that a stop need not cancel it.
    detached
        Whether it goes on when all who waited for it have left.
    cached
        Whether the next job of the same key has the same result, which is kept ready.

    """

    kind: str
    key: str
    event: Callable[[Progress], Event]
    run: Callable[[Report], Coroutine[Any, Any, Result]]
    resumable: bool = False
    detached: bool = False
    cached: bool = False


def events_about(kind: str, **about: Any) -> Callable[[Progress], Event]:
    """Return what makes the events of a job that has no frames to show."""

    def event(progress: Progress) -> Event:
        told = {name: getattr(progress, name) for name in ("stage", "done", "total", "eta_s")}
        return Event(kind, {**about, **told})

    return event


async def run_task(
    workers: Workers,
    task: AnyTask,
    report: Report,
    keep: Callable[[int, RecognizedTake], None] | None = None,
) -> Finished | Failed:
    """Run a task in a worker process; report its progress, keep its answers, return its end."""
    left, answered = TimeLeft(), 0

    async def hear(message: Progressed | Answered) -> None:
        nonlocal answered
        if isinstance(message, Progressed):
            eta = left.estimate(message.done, message.total, time.monotonic())
            report(message.model_copy(update={"eta_s": eta}))
        # A repeated process gives its earlier answers again.
        elif keep is not None and message.index == answered:
            await run_in_threadpool(keep, message.index, message.take)
            answered += 1

    return await workers.run(task, hear)


class TimeLeft:
    """Estimates the time left of one job."""

    def __init__(self) -> None:
        self._first: tuple[int, float] | None = None

    def estimate(self, done: int, total: int, now: float) -> float | None:
        """Return the seconds left; None while the rate is not known.

        Parameters
        ----------
        done, total
            Frames.
        now
            Seconds on a monotonic clock.

        """
        if self._first is None:
            self._first = (done, now)
        frames, elapsed = done - self._first[0], now - self._first[1]
        if frames <= 0 or elapsed <= 0 or done < LEAST_SHARE * total:
            return None
        return round(elapsed / frames * max(0, total - done), 1)


@dataclass(eq=False)
class _Run:
    """One execution of a job."""

    job: Job[Any]
    broadcast: Broadcast
    task: asyncio.Task[Any] = field(init=False)
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

    Attributes
    ----------
    stopped
        Whether the server is about to stop, so that new jobs are refused.

    """

    def __init__(self, broadcast: Broadcast, metrics: Metrics | None = None) -> None:
        self._broadcast = broadcast
        self._metrics = metrics or Metrics()
        self._runs: dict[str, _Run] = {}
        self._elsewhere: dict[str, Progress] = {}
        self.stopped = False

    async def run(self, job: Job[Result]) -> Result:
        """Run a job, or wait for the running one of the same key, and return its result.

        The job goes on when a caller is cancelled while others wait. When the last caller is
        cancelled, the job ends, unless it is resumable or detached.

        Raises
        ------
        JobCancelled
            When somebody cancels the job, or the server stops.

        """
        if job.key in _cached:
            _cached.move_to_end(job.key)
            cached: Result = _cached[job.key]
            return cached
        if job.key not in self._runs:
            self._start(job)
        run = self._runs[job.key]
        task: asyncio.Task[Result] = run.task
        run.waiting += 1
        try:
            # Not awaited directly: cancelling the job must not look like cancelling the caller.
            await asyncio.wait([task])
        finally:
            run.waiting -= 1
            if not (run.waiting or task.done() or job.resumable or job.detached):
                await self.cancel(job.key)
        if task.cancelled():
            raise JobCancelled
        return task.result()

    def progress(self, key: str) -> Progress | None:
        """Return the progress of a job, here or on another server; None if it is not running."""
        if key in self._runs:
            return self._runs[key].progress
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
        run = self._runs.pop(key)
        run.cancelled = True
        run.task.cancel()
        await asyncio.wait([run.task])
        return True

    async def stop(self) -> None:
        """Cancel the jobs that are not resumable, and refuse new ones."""
        self.stopped = True
        for key in [key for key, run in self._runs.items() if not run.job.resumable]:
            await self.cancel(key)

    def _start(self, job: Job[Any]) -> None:
        if self.stopped and not job.resumable:
            raise JobCancelled
        run = self._runs[job.key] = _Run(job, self._broadcast)
        run.task = asyncio.create_task(self._observe(job, run))
        run.task.add_done_callback(lambda _: self._end(run))

    async def _observe(self, job: Job[Result], run: _Run) -> Result:
        """Run a job; log and measure how it ends."""
        job_id.set(job.key)
        began, outcome = time.monotonic(), "failed"
        try:
            result = await job.run(run.report)
            outcome = "failed" if isinstance(result, Failed) else "done"
            if job.cached and outcome == "done":
                _cached[job.key] = result
                while len(_cached) > CACHED_RESULTS:
                    _cached.popitem(last=False)
            return result
        except (asyncio.CancelledError, JobCancelled):
            outcome = "cancelled"
            raise
        finally:
            seconds = time.monotonic() - began
            self._metrics.jobs.labels(job.kind, outcome).observe(seconds)
            fields = {"kind": job.kind, "outcome": outcome, "seconds": round(seconds, 3)}
            logger.info("job ended", extra={FIELDS: fields})

    def _end(self, run: _Run) -> None:
        if self._runs.get(run.job.key) is run:
            del self._runs[run.job.key]


async def compute_in_place(places: asyncio.Semaphore, compute: Callable[[], Result]) -> Result:
    """Compute in a thread, which keeps its place until it ends, even if the caller is cancelled.

    A thread cannot be interrupted. Were its place free at once, any number of threads would compute
    for clients who have left.
    """
    await places.acquire()
    computing = asyncio.create_task(run_in_threadpool(compute))

    def leave(ended: asyncio.Task[Result]) -> None:
        places.release()
        if not ended.cancelled():
            ended.exception()  # perhaps nobody else asks for it

    computing.add_done_callback(leave)
    await asyncio.wait([computing])
    return computing.result()
