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
    request: Request, studio: Studio, job: Job[Made], cancelled: str = "", code: str = ""
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
    cancelled, code
        What to say, and the problem's code, when somebody cancels it; empty: nobody can.

    Raises
    ------
    ProblemError
        409 when it was cancelled, 503 when the server stops.
    ClientDisconnect
        When the client has left.

    """
    try:
        return await while_connected(request, studio.runner.run(job))
    except JobCancelled as error:
        if studio.stopping.is_set() or not code:
            raise stopping() from error
        raise ProblemError(409, code, cancelled) from error
