"""Extraction job: finds the poses of one clip in a worker process; kept in the database."""

from __future__ import annotations

import time
from contextlib import aclosing
from dataclasses import asdict
from typing import Literal

from app.api.events.broadcast import Event
from app.api.jobs.job import Progress, Report
from app.api.jobs.persistence import persist
from app.api.jobs.time_left import TimeLeft
from app.api.workers.clip_files import ClipFiles
from app.api.workers.worker_messages import Failed, Finished, Progressed
from app.api.workers.worker_processes import Workers
from app.clip_sources import ReadOptions, source_named
from app.store import Clip, ClipStore, Job, JobStatus, JobStore, NotFound
from app.store.clips import FILMSTRIP, POSTER, RECORDING
from app.store.models import VIDEO


class ExtractionJob:
    """Runs a job of the store, and stores its outcome.

    Parameters
    ----------
    job
        The stored job, already marked as running.
    clips, jobs
        The store.
    workers
        Starts the process.

    """

    resumable: Literal[True] = True

    def __init__(self, job: Job, clips: ClipStore, jobs: JobStore, workers: Workers) -> None:
        self._job = job
        self._clips = clips
        self._jobs = jobs
        self._workers = workers

    @property
    def key(self) -> str:
        """Id of the stored job."""
        return self._job.id

    def event(self, progress: Progress) -> Event:
        """Return the event with the progress of the job."""
        event = job_event(self._job)
        return Event(event.kind, {**event.data, "progress": asdict(progress)})

    async def run(self, report: Report) -> Failed | None:
        """Extract the clip, unless it was cancelled or deleted meanwhile; return why it failed."""
        if not await persist(self._jobs.is_running, self._job.id):
            return None
        report(Progress("starting"))
        try:
            clip = (await persist(self._clips.get, self._job.clip_id)).clip
        except NotFound:
            return None
        messages = self._workers.record(
            source_named(clip.source),
            await persist(self._clips.received, clip),
            options_of(clip),
            files_to_write(self._clips, clip.id),
        )
        left = TimeLeft()
        end: Finished | Failed | None = None
        async with aclosing(messages) as steps:
            async for message in steps:
                if isinstance(message, Progressed):
                    report(_progress(message, left))
                else:
                    end = message
        # After the end of the worker, because storing may have to wait for the database.
        match end:
            case Finished(frames=frames, warnings=warnings, salute_warnings=of_salutes):
                await persist(self._clips.keep_found, clip)
                await persist(self._jobs.complete, self._job.id, frames, warnings, of_salutes)
            case Failed(code=code, detail=detail):
                await persist(
                    self._jobs.finish, self._job.id, JobStatus.FAILED, code=code, error=detail
                )
        return end if isinstance(end, Failed) else None


def job_event(job: Job) -> Event:
    """Return the event about a stored job."""
    return Event("jobs", {"id": job.id, "clip_id": job.clip_id})


def options_of(clip: Clip) -> ReadOptions:
    """Return how the file of a stored clip is read."""
    options = ReadOptions()
    if clip.options is not None:
        options = ReadOptions.model_validate_json(clip.options)
    return options.model_copy(update={"topic": clip.topic})


def files_to_write(clips: ClipStore, clip_id: str) -> ClipFiles:
    """Return the paths to which the parts of a clip are written."""
    return ClipFiles(
        *(clips.place(clip_id, name) for name in (VIDEO, RECORDING, POSTER, FILMSTRIP))
    )


def files_of(clips: ClipStore, clip_id: str) -> ClipFiles:
    """Return the paths of the stored parts of a clip.

    Raises
    ------
    StoreUnavailable
        When one of them is not on this machine, and the object store does not answer.

    """
    return ClipFiles(
        clips.video(clip_id),
        clips.recording(clip_id),
        clips.poster(clip_id),
        clips.filmstrip(clip_id),
    )


def _progress(message: Progressed, left: TimeLeft) -> Progress:
    """Return the progress with the time left, from the rate so far."""
    eta = left.estimate(message.done, message.total, time.monotonic())
    return Progress(message.stage, message.done, message.total, eta, message.time, message.pose)
