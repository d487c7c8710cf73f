"""Extraction queue: runs the stored jobs a few at a time, in turn between clients."""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress

from starlette.concurrency import run_in_threadpool

from app.api.events.broadcast import Broadcast
from app.api.jobs.extraction import ExtractionJob, job_event
from app.api.jobs.fair_queue import FairQueue
from app.api.jobs.job import JobCancelled
from app.api.jobs.persistence import persist
from app.api.jobs.runner import JobRunner
from app.api.workers.worker_processes import Workers
from app.store import ClipStore, Job, JobStatus, JobStore, StoreError

RENEW_SECONDS = 10.0
"""Seconds between two renewals: a server may miss three before another one takes over its jobs."""

logger = logging.getLogger(__name__)


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
    count
        Number of jobs that run at the same time.

    """

    def __init__(
        self,
        runner: JobRunner,
        clips: ClipStore,
        jobs: JobStore,
        workers: Workers,
        broadcast: Broadcast,
        count: int,
    ) -> None:
        self._runner = runner
        self._clips = clips
        self._jobs = jobs
        self._workers = workers
        self._broadcast = broadcast
        self._count = count
        self._waiting = FairQueue()
        self._running: set[str] = set()
        self._loops: list[asyncio.Task[None]] = []
        self._look = asyncio.Event()

    async def start(self) -> None:
        """Requeue the jobs that an earlier run left open, and start the workers."""
        for job in await run_in_threadpool(self._jobs.resume):
            await self._waiting.put(job.client, job.id)
        self._loops = [asyncio.create_task(self._work()) for _ in range(self._count)]
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
            with suppress(StoreError):
                await run_in_threadpool(self._jobs.requeue, job_id)

    async def submit(self, job: Job) -> None:
        """Let a job wait for its turn."""
        await self._waiting.put(job.client, job.id)
        self._broadcast.send(job_event(job))

    async def cancel(self, job: Job) -> bool:
        """Cancel a waiting or running job; return whether it waited or ran."""
        cancelled = await run_in_threadpool(self._jobs.finish, job.id, JobStatus.CANCELLED)
        await self._runner.cancel(job.id)
        if cancelled:
            self._publish(job)
        return cancelled

    async def _work(self) -> None:
        while True:
            job_id = await self._waiting.get()
            try:
                if job := await persist(self._jobs.start, job_id):
                    await self._run(job)
            except Exception:
                # The failure of one job, such as a full disk, must not end the loop for all others.
                logger.exception("job %s could not be run", job_id)
                await self._give_up(job_id)

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
            except StoreError as error:
                logger.warning("the leases of jobs cannot be renewed now: %s", error)

    async def _run(self, job: Job) -> None:
        self._running.add(job.id)
        try:
            with suppress(JobCancelled):
                await self._runner.run(ExtractionJob(job, self._clips, self._jobs, self._workers))
        finally:
            self._running.discard(job.id)
        self._publish(job)

    async def _give_up(self, job_id: str) -> None:
        error = "the server could not keep what it found in this clip; try again"
        try:
            await persist(self._jobs.finish, job_id, JobStatus.FAILED, code="internal", error=error)
        except StoreError:
            logger.exception("the end of job %s could not be stored", job_id)

    def _publish(self, job: Job) -> None:
        self._broadcast.send(job_event(job))
        self._broadcast.publish("clips", id=job.clip_id)
