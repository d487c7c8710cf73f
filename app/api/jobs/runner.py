"""Runs the jobs that wait, a few at a time, and knows how far each of them is."""

from __future__ import annotations

import asyncio
import logging
import time
from contextlib import aclosing, suppress
from dataclasses import dataclass
from pathlib import Path

from starlette.concurrency import run_in_threadpool

from app.api.events.broadcast import Broadcast
from app.api.extraction import process
from app.api.extraction.clip_files import ClipFiles
from app.api.extraction.keypoint_source import KeypointSource
from app.api.extraction.messages import (
    BagProbed,
    Failed,
    Finished,
    KeypointsProbed,
    Pose,
    Probed,
    Progressed,
)
from app.api.extraction.queue import FairQueue
from app.settings import Settings
from app.store import ClipStore, Job, JobStatus, JobStore, NotFound, StoreError

MOST_PROBES = 2
"""Received files looked into, and sessions written, at the same time: a hundred uploads must not be
as many processes."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Progress:
    """How far a running job is.

    Attributes
    ----------
    stage
        ``starting``, ``poses`` or ``saving``.
    done, total
        Frames; `total` is an estimate where the container does not count them.
    eta_s
        Seconds still to go at the present rate, or None before there is one.
    time
        Seconds after the clip's first frame, of the newest frame whose landmarks were found; None
        in the other stages.
    pose
        The body in that frame, or None where nobody is in it.

    """

    stage: str
    done: int = 0
    total: int = 0
    eta_s: float | None = None
    time: float | None = None
    pose: Pose | None = None


class ExtractionRunner:
    """Extracts poses from clips in worker processes.

    Parameters
    ----------
    settings
        Limits of the workers, and how many at once.
    clips, jobs
        Where the files are, and what is to be done.
    broadcast
        Hears of every step as ``jobs``, and of every end as ``clips``.

    """

    def __init__(
        self, settings: Settings, clips: ClipStore, jobs: JobStore, broadcast: Broadcast
    ) -> None:
        self._settings = settings
        self._clips = clips
        self._jobs = jobs
        self._broadcast = broadcast
        self._queue = FairQueue()
        self._progress: dict[str, Progress] = {}
        self._running: dict[str, asyncio.Task[None]] = {}
        self._probing = asyncio.Semaphore(MOST_PROBES)
        self._loops: list[asyncio.Task[None]] = []

    async def start(self) -> None:
        """Queue again what an earlier server left open, and begin to work."""
        for job in await run_in_threadpool(self._jobs.resume):
            await self._queue.put(job.client, job.id)
        self._loops = [asyncio.create_task(self._work()) for _ in range(self._settings.workers)]

    async def stop(self) -> None:
        """End the workers; their jobs are queued again for the next start."""
        running = list(self._running)
        for task in (*self._loops, *self._running.values()):
            task.cancel()
        await asyncio.gather(*self._loops, *self._running.values(), return_exceptions=True)
        for job_id in running:
            await run_in_threadpool(self._jobs.requeue, job_id)

    async def submit(self, job: Job) -> None:
        """Let a job wait for its turn."""
        await self._queue.put(job.client, job.id)
        self._tell(job.id, job.clip_id)

    async def probe(self, clip: Path) -> Probed | Failed:
        """Look into a received file, in a process of its own."""
        async with self._probing:
            return await process.probe(clip, self._settings)

    async def probe_bag(self, bag: Path) -> BagProbed | Failed:
        """Look into a received dive recording, in a process of its own."""
        async with self._probing:
            return await process.probe_bag(bag, self._settings)

    async def probe_keypoints(self, file: Path, told: KeypointSource) -> KeypointsProbed | Failed:
        """Look into a received keypoint file, in a process of its own."""
        async with self._probing:
            return await process.probe_keypoints(file, told, self._settings)

    async def write_session(self, clip_id: str, wishes: bytes, session: Path) -> Finished | Failed:
        """Write a clip's session as MCAP, in a process of its own."""
        async with self._probing:
            return await process.write_session(
                wishes, session, self._files(clip_id), self._settings
            )

    async def cancel(self, job: Job) -> bool:
        """End a job that waits or runs; return whether it did."""
        cancelled = await run_in_threadpool(self._jobs.finish, job.id, JobStatus.CANCELLED)
        if task := self._running.get(job.id):
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        if cancelled:
            self._tell(job.id, job.clip_id)
            self._broadcast.publish("clips", id=job.clip_id)
        return cancelled

    def progress(self, job_id: str) -> Progress | None:
        """Return how far a job is, or None when it does not run."""
        return self._progress.get(job_id)

    async def _work(self) -> None:
        while True:
            job_id = await self._queue.get()
            try:
                if job := await run_in_threadpool(self._jobs.start, job_id):
                    await self._supervise(job)
            except Exception:
                # One job's trouble, such as a full disk, must not end the loop for all others.
                logger.exception("job %s could not be run", job_id)
                await self._give_up(job_id)

    async def _give_up(self, job_id: str) -> None:
        error = "the server could not keep what it found in this clip; try again"
        # When not even that can be written, the next start runs the job again.
        with suppress(StoreError):
            await run_in_threadpool(
                self._jobs.finish, job_id, JobStatus.FAILED, code="internal", error=error
            )

    async def _supervise(self, job: Job) -> None:
        """Run one job in a task of its own, so that it can be cancelled alone."""
        task = asyncio.create_task(self._extract(job))
        self._running[job.id] = task
        try:
            await asyncio.wait([task])
        finally:
            self._running.pop(job.id, None)
            self._progress.pop(job.id, None)
        if not task.cancelled():
            task.result()
        self._tell(job.id, job.clip_id)
        self._broadcast.publish("clips", id=job.clip_id)

    async def _extract(self, job: Job) -> None:
        if not await run_in_threadpool(self._jobs.is_running, job.id):
            return  # Cancelled after it was started and before it could be found here.
        self._show(job, Progress("starting"))
        try:
            clip = (await run_in_threadpool(self._clips.get, job.clip_id)).clip
        except NotFound:
            return  # Deleted meanwhile; its job is about to be cancelled.
        files = self._files(clip.id)
        if clip.keypoints is not None:
            told = KeypointSource.model_validate_json(clip.keypoints)
            file = self._clips.keypoints(clip.id)
            messages = process.extract_keypoints(file, told, files, self._settings)
        elif clip.from_bag:
            bag = self._clips.bag(clip.id)
            messages = process.extract_bag(bag, clip.topic, files, self._settings)
        else:
            messages = process.extract(files, self._settings)
        started: float | None = None
        async with aclosing(messages) as steps:
            async for message in steps:
                match message:
                    case Progressed():
                        started = started or time.monotonic()
                        elapsed = time.monotonic() - started
                        self._show(job, _estimate(message, elapsed))
                    case Finished(frames=frames, warnings=warnings):
                        await run_in_threadpool(self._jobs.complete, job.id, frames, warnings)
                    case Failed(code=code, detail=detail):
                        failed = JobStatus.FAILED
                        await run_in_threadpool(
                            self._jobs.finish, job.id, failed, code=code, error=detail
                        )

    def _files(self, clip_id: str) -> ClipFiles:
        clips = self._clips
        return ClipFiles(
            clips.video(clip_id),
            clips.recording(clip_id),
            clips.poster(clip_id),
            clips.filmstrip(clip_id),
        )

    def _show(self, job: Job, progress: Progress) -> None:
        self._progress[job.id] = progress
        self._tell(job.id, job.clip_id)

    def _tell(self, job_id: str, clip_id: str) -> None:
        self._broadcast.publish("jobs", id=job_id, clip_id=clip_id)


def _estimate(message: Progressed, elapsed: float) -> Progress:
    """Add the time left, from the rate so far; `elapsed` seconds since the first report."""
    left = message.total - message.done
    eta = round(elapsed / message.done * left, 1) if message.done and elapsed > 0 else None
    return Progress(message.stage, message.done, message.total, eta, message.time, message.pose)
