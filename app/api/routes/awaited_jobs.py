"""Jobs that a request waits for: they end with the client, the server, or when cancelled."""

from __future__ import annotations

from typing import TypeVar

from fastapi import Request

from app.api.http.connection import while_connected
from app.api.http.problems import ProblemError
from app.api.jobs.job import Job, JobCancelled, JobRunner
from app.api.middleware.shutdown import stopping

Made = TypeVar("Made")


async def await_job(
    request: Request, runner: JobRunner, job: Job[Made], cancelled: ProblemError | None = None
) -> Made:
    """Run a job, or join it, while the client waits; return what it made.

    Parameters
    ----------
    request
        Request of the client.
    runner
        Runs it.
    job
        The job.
    cancelled
        What to answer when somebody cancels it; None: nobody can.

    Raises
    ------
    ProblemError
        `cancelled`, or 503 when the server stops.
    ClientDisconnect
        When the client has left.

    """
    try:
        return await while_connected(request, runner.run(job))
    except JobCancelled as error:
        if cancelled is None or runner.stopped:
            raise stopping() from error
        raise cancelled from error
