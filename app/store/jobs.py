"""Job store: queue, state and result of every extraction."""

from __future__ import annotations

import json
from collections.abc import Sequence

from sqlmodel import col, func, select

from app.store.database import Database
from app.store.errors import NotFound
from app.store.models import Clip, Job, JobStatus, now

MAX_ATTEMPTS = 3
"""Starts after which a job that never came to an end is given up: it may be what ends us."""

_OPEN = (JobStatus.QUEUED.value, JobStatus.RUNNING.value)


class JobStore:
    """Keeps jobs in `database`; every change of status is one transaction."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def get(self, job_id: str) -> Job:
        """Return a job whose clip is not deleted.

        Raises
        ------
        NotFound
            When there is none.

        """
        with self._database.reading() as session:
            query = select(Job).join(Clip).where(Job.id == job_id, col(Clip.deleted).is_(None))
            if (job := session.exec(query).first()) is None:
                raise NotFound(f"there is no job {job_id!r}")
            return job

    def count_open(self, client: str) -> int:
        """Count the jobs of `client` that wait or run."""
        with self._database.reading() as session:
            query = select(func.count()).select_from(Job)
            query = query.where(Job.client == client, col(Job.status).in_(_OPEN))
            return session.exec(query).one()

    def count_by_status(self) -> dict[str, int]:
        """Count the jobs that wait and those that run."""
        with self._database.reading() as session:
            query = select(col(Job.status), func.count()).where(col(Job.status).in_(_OPEN))
            counts = dict(session.exec(query.group_by(col(Job.status))).all())
        return {status: counts.get(status, 0) for status in _OPEN}

    def resume(self) -> list[Job]:
        """Queue again what was running when the server ended; return all that waits, oldest first.

        A job that was started `MAX_ATTEMPTS` times without coming to an end fails instead.
        """
        with self._database.writing() as session:
            jobs = session.exec(
                select(Job).where(col(Job.status).in_(_OPEN)).order_by(col(Job.created))
            ).all()
            for job in jobs:
                if job.attempts >= MAX_ATTEMPTS:
                    job.status, job.finished = JobStatus.FAILED.value, now()
                    job.error_code = "interrupted"
                    job.error = (
                        f"the server ended {job.attempts} times while it read this clip; "
                        "delete the clip, or convert it to another format and try again"
                    )
                else:
                    job.status = JobStatus.QUEUED.value
                session.add(job)
        return [job for job in jobs if job.status == JobStatus.QUEUED]

    def start(self, job_id: str) -> Job | None:
        """Mark a waiting job as running; ``None`` when it was cancelled or removed meanwhile."""
        with self._database.writing() as session:
            job = session.get(Job, job_id)
            if job is None or job.status != JobStatus.QUEUED:
                return None
            job.status, job.started = JobStatus.RUNNING.value, now()
            job.attempts += 1
            session.add(job)
            return job

    def is_running(self, job_id: str) -> bool:
        """Return whether a job was started and is neither over nor removed."""
        with self._database.reading() as session:
            job = session.get(Job, job_id)
            return job is not None and job.status == JobStatus.RUNNING

    def requeue(self, job_id: str) -> None:
        """Put a running job back, because the server stops in good order."""
        with self._database.writing() as session:
            job = session.get(Job, job_id)
            if job is not None and job.status == JobStatus.RUNNING:
                job.status = JobStatus.QUEUED.value
                job.attempts -= 1
                session.add(job)

    def complete(self, job_id: str, frames: int, warnings: Sequence[str]) -> bool:
        """End a job that found what it looked for; return whether it was still open.

        Parameters
        ----------
        job_id
            Which one.
        frames
            How many were decoded; noted with the clip.
        warnings
            What the user should know about the clip.

        """
        with self._database.writing() as session:
            job = session.get(Job, job_id)
            if job is None or JobStatus(job.status).final:
                return False
            job.status, job.finished, job.frames = JobStatus.DONE.value, now(), frames
            job.warnings = json.dumps(list(warnings), ensure_ascii=False)
            session.add(job)
            if clip := session.get(Clip, job.clip_id):
                clip.frames = frames
                session.add(clip)
            return True

    def retry(self, clip_id: str, client: str) -> Job | None:
        """Queue another job for a clip; ``None`` when one is open or was done already."""
        with self._database.writing() as session:
            query = select(Job).where(Job.clip_id == clip_id)
            if any(job.status in (*_OPEN, JobStatus.DONE) for job in session.exec(query)):
                return None
            job = Job(clip_id=clip_id, client=client)
            session.add(job)
            return job

    def finish(
        self, job_id: str, status: JobStatus, *, code: str | None = None, error: str | None = None
    ) -> bool:
        """End a job that found nothing; return whether it was still open.

        Parameters
        ----------
        job_id
            Which one.
        status
            Failed or cancelled.
        code
            Stable word for why it failed.
        error
            The same as one line for a person.

        """
        with self._database.writing() as session:
            job = session.get(Job, job_id)
            if job is None or JobStatus(job.status).final:
                return False
            job.status, job.finished = status.value, now()
            job.error_code, job.error = code, error
            session.add(job)
            return True
