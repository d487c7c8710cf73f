"""Extractions: finding the poses of stored clips, a few at a time, in turn between clients."""

from __future__ import annotations

import asyncio
import logging
from collections import Counter, OrderedDict, deque
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import ParamSpec, TypeVar

from starlette.concurrency import run_in_threadpool

from app import store
from app.api.events.broadcast import Broadcast, Event
from app.api.jobs.job import Job as RunningJob
from app.api.jobs.job import JobCancelled, JobRunner, Report, run_task
from app.api.workers.tasks import Record
from app.api.workers.worker_messages import Failed, Finished, Progress
from app.api.workers.worker_processes import Workers
from app.clip_sources import ReadOptions
from app.settings import Settings
from app.store.atomic_files import PARTIAL_SUFFIX
from app.store.clips import FILMSTRIP, POSTER, RECORDING, SO_FAR

RENEW_SECONDS = 10.0
"""Seconds between two renewals: a server may miss three before another one takes over its jobs."""

FIRST_PAUSE_SECONDS = 0.5
LONGEST_PAUSE_SECONDS = 5.0
"""Longest pause between attempts: short enough that nobody waits long once the database is back."""

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

logger = logging.getLogger(__name__)


def job_event(job: store.Job) -> Event:
    """Return the event about a stored job."""
    return Event("jobs", {"id": job.id, "clip_id": job.clip_id})


def options_of(clip: store.Clip) -> ReadOptions:
    """Return how the file of a stored clip is read."""
    options = ReadOptions.model_validate(clip.options or {})
    return options.model_copy(update={"topic": clip.topic})


class ExtractionQueue:
    """Runs extraction jobs; jobs that are open when the server stops run at the next start.

    Parameters
    ----------
    runner
        Runs each job.
    clips, jobs
        The store.
    workers
        Starts the processes.
    broadcast
        Publishes every step as ``jobs``, and every end as ``clips``.
    settings
        How many jobs run at the same time, and whether colours are corrected.
    find_known
        Returns the recording that comes with the program for a clip's file; None without one.

    """

    def __init__(
        self,
        runner: JobRunner,
        clips: store.ClipStore,
        jobs: store.JobStore,
        workers: Workers,
        broadcast: Broadcast,
        settings: Settings,
        find_known: Callable[[Path], Path | None] = lambda file: None,
    ) -> None:
        self._find_known = find_known
        self._runner = runner
        self._clips = clips
        self._jobs = jobs
        self._workers = workers
        self._broadcast = broadcast
        self._settings = settings
        self._waiting = FairQueue(settings.workers)
        self._running: set[str] = set()
        self._loops: list[asyncio.Task[None]] = []
        self._look = asyncio.Event()

    async def start(self) -> None:
        """Requeue the jobs that an earlier run left open, and start the workers."""
        for job in await run_in_threadpool(self._jobs.resume):
            await self._waiting.put(job.client, job.id)
        places = self._settings.workers + 1
        self._loops = [asyncio.create_task(self._work()) for _ in range(places)]
        self._loops.append(asyncio.create_task(self._keep_up()))

    def look(self) -> None:
        """Check soon for changes of jobs by other servers; call it on the event loop."""
        self._look.set()

    async def stop(self) -> None:
        """End the workers; their jobs are queued again for the next start."""
        running = list(self._running)
        for loop in self._loops:
            loop.cancel()
        await asyncio.gather(*self._loops, return_exceptions=True)
        for job_id in running:
            await self._runner.cancel(job_id)
            # If this cannot be stored either, the next start finds the job running.
            with suppress(store.StoreError):
                await run_in_threadpool(self._jobs.requeue, job_id)

    async def submit(self, job: store.Job) -> None:
        """Let a job wait for its turn."""
        await self._waiting.put(job.client, job.id)
        self._broadcast.send(job_event(job))

    async def cancel(self, job: store.Job) -> bool:
        """Cancel a waiting or running job; return whether it waited or ran."""
        cancelled = await run_in_threadpool(self._jobs.finish, job.id, store.JobStatus.CANCELLED)
        await self._runner.cancel(job.id)
        if cancelled:
            self._publish(job)
        return cancelled

    async def _work(self) -> None:
        while True:
            client, job_id = await self._waiting.get()
            try:
                if job := await persist(self._jobs.start, job_id):
                    await self._run(job)
            except Exception:
                # The failure of one job, such as a full disk, must not end the loop for all others.
                logger.exception("job %s could not be run", job_id)
                await self._give_up(job_id)
            finally:
                self._waiting.release(client)

    async def _keep_up(self) -> None:
        """Renew the leases of this server's jobs, and take over those that other servers left."""
        while True:
            with suppress(TimeoutError):
                await asyncio.wait_for(self._look.wait(), RENEW_SECONDS)
            self._look.clear()
            try:
                if running := set(self._running):
                    kept = await run_in_threadpool(self._jobs.renew, running)
                    for job_id in running - kept:
                        await self._runner.cancel(job_id)
                for job in await run_in_threadpool(self._jobs.take_over):
                    await self._waiting.put(job.client, job.id)
            except store.StoreError as error:
                logger.warning("the leases of jobs cannot be renewed now: %s", error)

    async def _run(self, job: store.Job) -> None:
        def event(progress: Progress) -> Event:
            event, told = job_event(job), progress.model_dump(exclude={"kind"})
            return Event(event.kind, {**event.data, "progress": told})

        run = partial(self._extract, job)
        self._running.add(job.id)
        try:
            with suppress(JobCancelled):
                await self._runner.run(RunningJob("extraction", job.id, event, run, resumable=True))
        finally:
            self._running.discard(job.id)
        self._publish(job)

    async def _extract(self, job: store.Job, report: Report) -> Finished | Failed | None:
        """Extract a clip, unless its job was cancelled or it was deleted; return how it ended."""
        if not await persist(self._jobs.is_running, job.id):
            return None
        report(Progress(stage="starting"))
        try:
            clip = (await persist(self._clips.get, job.clip_id)).clip
        except store.NotFound:
            return None
        place = self._clips.place
        if clip.turn:
            self._clips.forget_pictures(clip.id)
        file = await persist(self._clips.received, clip)
        so_far = place(clip.id, SO_FAR)
        task = Record(
            source=clip.source,
            file=file,
            known=None if clip.turn else await run_in_threadpool(self._find_known, file),
            options=options_of(clip).model_copy(update={"water": self._settings.water}),
            video=place(clip.id, clip.video_name) if clip.video_is_made else None,
            recording=place(clip.id, RECORDING),
            so_far=None if clip.video_is_made else so_far,
            poster=place(clip.id, POSTER),
            filmstrip=place(clip.id, FILMSTRIP),
        )
        # Stored after the end of the worker, because storing may have to wait for the database.
        so_far.unlink(missing_ok=True)
        try:
            match ended := await run_task(self._workers, task, report):
                case Finished() as found:
                    await persist(self._clips.keep_found, clip)
                    warnings = found.warnings, found.salute_warnings
                    complete = partial(self._jobs.complete, seconds=found.seconds)
                    await persist(complete, job.id, found.frames, *warnings)
                case Failed(code=code, detail=detail):
                    failed = partial(self._jobs.finish, code=code, error=detail)
                    await persist(failed, job.id, store.JobStatus.FAILED)
        finally:
            # A process that died leaves what it was writing.
            written = [each.with_suffix(PARTIAL_SUFFIX) for each in task.files.outputs]
            for left in (so_far, *written, *so_far.parent.glob(f".*{PARTIAL_SUFFIX}")):
                left.unlink(missing_ok=True)
        return ended

    async def _give_up(self, job_id: str) -> None:
        error = "the server could not keep what it found in this clip; try again"
        try:
            await persist(
                self._jobs.finish, job_id, store.JobStatus.FAILED, code="internal", error=error
            )
        except store.StoreError:
            logger.exception("the end of job %s could not be stored", job_id)

    def _publish(self, job: store.Job) -> None:
        self._broadcast.send(job_event(job))
        self._broadcast.publish("clips", id=job.clip_id)


class FairQueue:
    """Ids of waiting jobs by client; neither a hundred jobs nor a long one delay other clients.

    Parameters
    ----------
    most
        Jobs at the same time; one more if it is of a client of whom none runs.

    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._waiting: OrderedDict[str, deque[str]] = OrderedDict()
        self._running: Counter[str] = Counter()
        self._known: set[str] = set()
        self._changed = asyncio.Condition()

    async def put(self, client: str, job_id: str) -> None:
        """Add a job at the end of its client's queue, unless it is in it already."""
        async with self._changed:
            if job_id in self._known:
                return
            self._known.add(job_id)
            self._waiting.setdefault(client, deque()).append(job_id)
            self._changed.notify_all()

    async def get(self) -> tuple[str, str]:
        """Take the next job, waiting for one; return its client too, see `release`."""
        async with self._changed:
            await self._changed.wait_for(self._next)
            client = self._next()
            assert client is not None
            jobs = self._waiting[client]
            self._running[client] += 1
            job_id = jobs.popleft()
            self._known.discard(job_id)
            if jobs:
                self._waiting.move_to_end(client)
            else:
                del self._waiting[client]
            return client, job_id

    def release(self, client: str) -> None:
        """Count a job of a client as ended; whoever took it looks for the next one."""
        self._running[client] -= 1
        self._running += Counter()  # Keeps no client of whom none runs.

    def _next(self) -> str | None:
        """Return the client whose turn it is; None while its job must wait."""
        full = self._running.total() >= self._most
        free = (each for each in self._waiting if not (full and each in self._running))
        return next(free, None)


async def persist(
    call: Callable[Arguments, Result], *args: Arguments.args, **kwargs: Arguments.kwargs
) -> Result:
    """Call a method of the store in a thread, and repeat it while the database is locked or full.

    A job whose end is not stored would seem to run for ever. Cancelling the task ends the attempts.
    """
    pause = FIRST_PAUSE_SECONDS
    while True:
        try:
            return await run_in_threadpool(call, *args, **kwargs)
        except store.StoreUnavailable as error:
            if pause == FIRST_PAUSE_SECONDS:
                logger.warning("a job's state cannot be stored yet: %s", error)
            await asyncio.sleep(pause)
            pause = min(2 * pause, LONGEST_PAUSE_SECONDS)
