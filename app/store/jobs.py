"""Job store: queue, state and result of every extraction."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from datetime import timedelta

from sqlalchemy import ColumnElement, and_, or_
from sqlmodel import Session, col, func, select

from app.store.database import Database, DatabaseStore, NotFound, moment_of
from app.store.models import Clip, Job, JobStatus, now

MAX_ATTEMPTS = 3
"""Number of starts after which an unfinished job is given up: it may be the cause of our
crashes."""

MOST_OFF, MOST_OFF_SHARE = 0.5, 0.1
"""Seconds, and share of the measured duration, by which a stated one may be wrong, whichever is
greater: sound may last longer than the picture."""

_RUNNING = col(Job.status) == JobStatus.RUNNING.value
_OPEN = (JobStatus.QUEUED.value, JobStatus.RUNNING.value)


LEASE = timedelta(seconds=45)
"""Time for which a server owns a job it starts, unless it renews the lease (`JobStore.renew`): a
server must not lose its jobs because it is busy or the database does not answer for seconds."""

MOST_RESUMED = 1000
"""Most waiting jobs that are read at once; further ones are read when these have begun."""


class JobStore(DatabaseStore):
    """Keeps jobs; every change of status is one transaction.

    A running job belongs to the server that started it, which renews its lease. After the lease any
    server may queue the job again; a later result of the former server has no effect.

    Parameters
    ----------
    database
        Where they are.
    server
        Id of this server.

    """

    def __init__(self, database: Database, server: str = "") -> None:
        super().__init__(database)
        self._server = server

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
        """Requeue the jobs that this server ran when it ended; return waiting jobs, oldest first.

        A job that was started `MAX_ATTEMPTS` times without coming to an end fails instead.
        """
        with self._database.writing() as session:
            mine = or_(col(Job.server) == self._server, col(Job.server).is_(None))
            return _requeue(session, or_(mine, _overdue(session)))

    def take_over(self) -> list[Job]:
        """Requeue the jobs that other servers left running; return waiting jobs, oldest first."""
        others = col(Job.server) != self._server
        with self._database.reading() as session:
            left = select(Job.id).where(_RUNNING, others, _overdue(session))
            if session.exec(left).first() is None:
                return _waiting(session)
        with self._database.writing() as session:
            return _requeue(session, and_(others, _overdue(session)))

    def renew(self, job_ids: Collection[str]) -> set[str]:
        """Renew the leases of running jobs; return the ids of those that this server still owns."""
        with self._database.writing(counted=False) as session:
            until = moment_of(session) + LEASE
            query = select(Job).where(
                col(Job.id).in_(job_ids), _RUNNING, Job.server == self._server
            )
            kept = session.exec(query).all()
            for job in kept:
                job.lease = until
            return {job.id for job in kept}

    def start(self, job_id: str) -> Job | None:
        """Mark a waiting job as running; ``None`` when it was cancelled or removed meanwhile."""
        with self._database.writing() as session:
            job = session.get(Job, job_id)
            if job is None or job.status != JobStatus.QUEUED:
                return None
            job.status, job.started = JobStatus.RUNNING.value, now()
            job.server, job.lease = self._server, moment_of(session) + LEASE
            job.attempts += 1
            return job

    def is_running(self, job_id: str) -> bool:
        """Return whether this server runs a job, which is neither final nor removed."""
        with self._database.reading() as session:
            return self._has(session.get(Job, job_id))

    def requeue(self, job_id: str) -> None:
        """Put a running job back into the queue, because the server shuts down."""
        with self._database.writing() as session:
            job = session.get(Job, job_id)
            if job is not None and self._has(job):
                job.status = JobStatus.QUEUED.value
                job.attempts -= 1

    def complete(
        self,
        job_id: str,
        frames: int,
        warnings: Sequence[str],
        salute_warnings: Sequence[str] = (),
        seconds: float | None = None,
    ) -> bool:
        """End a successful job; return whether this server still owned it.

        Parameters
        ----------
        job_id
            Which one.
        frames
            Number of decoded frames; stored with the clip.
        warnings, salute_warnings
            Sentences for the user about the clip: for every language, and for those with salutes.
        seconds
            Measured duration, stored with the clip if the container stated none or another one;
            None: not measured.

        """
        with self._database.writing() as session:
            job = session.get(Job, job_id)
            if job is None or not self._has(job):
                return False
            job.status, job.finished, job.frames = JobStatus.DONE.value, now(), frames
            job.warnings, job.salute_warnings = [*warnings], [*salute_warnings]
            if clip := session.get(Clip, job.clip_id):
                clip.frames = frames
                if seconds is not None and _contradicts(clip.duration, seconds):
                    clip.duration = seconds
            return True

    def retry(self, clip_id: str, client: str, *, anew: bool = False) -> Job | None:
        """Queue another job for a clip; ``None`` if one is open or, unless `anew`, successful."""
        ended = () if anew else (JobStatus.DONE,)
        with self._database.writing() as session:
            query = select(Job).where(Job.clip_id == clip_id)
            if any(job.status in (*_OPEN, *ended) for job in session.exec(query)):
                return None
            job = Job(clip_id=clip_id, client=client)
            session.add(job)
            if clip := session.get(Clip, clip_id):
                clip.job_id = job.id
            return job

    def finish(
        self, job_id: str, status: JobStatus, *, code: str | None = None, error: str | None = None
    ) -> bool:
        """End a failed or cancelled job; return whether it was still open.

        Any server may cancel a job; only the one that runs it may let it fail.

        Parameters
        ----------
        job_id
            Which one.
        status
            Failed or cancelled.
        code
            Stable word for the reason.
        error
            The reason as one line for a person.

        """
        with self._database.writing() as session:
            job = session.get(Job, job_id)
            if job is None or JobStatus(job.status).final:
                return False
            lost = job.status == JobStatus.RUNNING and not self._has(job)
            if lost and status is not JobStatus.CANCELLED:
                return False
            job.status, job.finished = status.value, now()
            job.error_code, job.error = code, error
            return True

    def _has(self, job: Job | None) -> bool:
        return job is not None and job.status == JobStatus.RUNNING and job.server == self._server


def _contradicts(stated: float | None, measured: float) -> bool:
    """Return whether a stated duration is missing, or wrong by more than containers round."""
    return stated is None or abs(stated - measured) > max(MOST_OFF, MOST_OFF_SHARE * measured)


def _overdue(session: Session) -> ColumnElement[bool]:
    return or_(col(Job.lease).is_(None), col(Job.lease) < moment_of(session))


def _requeue(session: Session, which: ColumnElement[bool]) -> list[Job]:
    """Queue those of the running jobs again; return all that wait then, oldest first."""
    for job in session.exec(select(Job).where(_RUNNING, which)):
        _queue_again(job)
    return _waiting(session)


def _queue_again(job: Job) -> None:
    if job.attempts >= MAX_ATTEMPTS:
        job.status, job.finished = JobStatus.FAILED.value, now()
        job.error_code = "interrupted"
        job.error = (
            f"the server ended {job.attempts} times while it read this clip; "
            "delete the clip, or convert it to another format and try again"
        )
    else:
        job.status = JobStatus.QUEUED.value


def _waiting(session: Session) -> list[Job]:
    query = select(Job).where(Job.status == JobStatus.QUEUED.value).order_by(col(Job.created))
    return list(session.exec(query.limit(MOST_RESUMED)))
