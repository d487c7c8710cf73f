"""Jobs that a request waits for: they end with the client, the server, or when cancelled."""

from __future__ import annotations

from typing import TypeVar

from fastapi import Request

from app.api.http.connection import while_connected
from app.api.http.problems import ProblemError
from app.api.jobs.job import Job, JobCancelled
from app.api.middleware.shutdown import stopping
from app.api.services.running_studio import Studio

Made = TypeVar("Made")


async def await_job(
    request: Request, studio: Studio, job: Job[Made], cancelled: ProblemError | None = None
) -> Made:
    """Run a job, or join it, while the client waits; return what it made.

    Parameters
    ----------
    request
        Request of the client.
    studio
        Running studio.
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
        return await while_connected(request, studio.runner.run(job))
    except JobCancelled as error:
        if cancelled is None or studio.stopping.is_set():
            raise stopping() from error
        raise cancelled from error
