"""Routes of extraction jobs: state, live progress, cancel."""

from __future__ import annotations

from collections.abc import AsyncIterator
from datetime import datetime
from functools import partial
from typing import Any

from fastapi import APIRouter, Request, Response
from sse_starlette import EventSourceResponse, ServerSentEvent
from starlette.concurrency import run_in_threadpool

from app.api.events.broadcast import Event
from app.api.http.problems import problem_responses
from app.api.http.schemas.values import View
from app.api.services.running_studio import CurrentStudio, Jobs, Runner, Studio
from app.api.workers.worker_messages import Progress
from app.recognition.poses.frame import Pose
from app.store import Job, JobStatus, NotFound

EVENT_STREAM: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "Server-sent events",
        "content": {"text/event-stream": {"schema": {"type": "string"}}},
    }
}
"""OpenAPI ``responses`` of an endless answer."""

FINAL_EVENT_ID = "final"
"""Id of a job's last event; a browser that reconnects with it gets a 204."""


class JobView(View):
    """How far a job is."""

    id: str
    clip_id: str
    status: JobStatus
    stage: str
    """queued, starting, poses, saving, or the final status."""
    done: int
    """Frames."""
    total: int
    """Frames; an estimate where the container does not count them."""
    eta_s: float | None
    """Seconds left at the present rate."""
    time: float | None
    """Seconds after the clip's first frame, of the frame that `pose` was found in; null in every
    stage but poses."""
    pose: Pose | None
    """The newest pose: of each of the 33 landmarks of the body (in the order of `landmarks` in a
    clip's poses) x and y as fractions of the picture's width and height, x right, y down; null: not
    seen. Null as a whole where nobody is in the frame."""
    kept: int
    """How often the poses so far were kept, to be shown before the end of the job."""
    error: str | None
    error_code: str | None
    created: datetime
    started: datetime | None
    finished: datetime | None


router = APIRouter(prefix="/jobs", tags=["jobs"])


@router.get("/{job_id}", responses=problem_responses(404))
def get_job(job_id: str, jobs: Jobs, runner: Runner) -> JobView:
    """Return how far a job is."""
    return view_job(jobs.get(job_id), runner.progress(job_id))


@router.get(
    "/{job_id}/events",
    response_class=EventSourceResponse,
    responses={**problem_responses(404), **EVENT_STREAM, 204: {"description": "The job is over"}},
)
async def follow_job(request: Request, job_id: str, studio: CurrentStudio) -> Response:
    """Stream a job's progress as server-sent events until it ends."""
    job = await run_in_threadpool(studio.jobs.get, job_id)
    over = JobStatus(job.status).final
    if over and request.headers.get("last-event-id") == FINAL_EVENT_ID:
        return Response(status_code=204)
    return EventSourceResponse(_progress_events(studio, job_id))


@router.delete("/{job_id}", responses=problem_responses(404))
async def cancel_job(job_id: str, studio: CurrentStudio) -> JobView:
    """Cancel a job that waits or runs; one that is over stays as it is."""
    job = await run_in_threadpool(studio.jobs.get, job_id)
    await studio.extractions.cancel(job)
    return view_job(await run_in_threadpool(studio.jobs.get, job_id), None)


def view_job(job: Job, progress: Progress | None) -> JobView:
    """Return a stored job with its progress."""
    status = JobStatus(job.status)
    frames = job.frames or 0
    over = Progress(stage=status.value, done=frames, total=frames)
    shown = progress if progress and status is JobStatus.RUNNING else over
    return JobView(
        **job.model_dump(include={"id", "clip_id", "error", "error_code"}),
        **job.model_dump(include={"created", "started", "finished"}),
        status=status,
        **dict(shown),
    )


async def _progress_events(studio: Studio, job_id: str) -> AsyncIterator[ServerSentEvent]:
    with studio.broadcast.subscribe() as events:
        view = await _current(studio, job_id)
        yield _event(view)
        if view is None or view.status.final:
            return
        async for event in events:
            if event.kind != "jobs" or event.data["id"] != job_id:
                continue
            view = await current_view(studio, event)
            yield _event(view)
            if view is None or view.status.final:
                return


async def current_view(studio: Studio, event: Event) -> JobView | None:
    """Return how the job of an event stands; the database is read once for all streams."""
    return await event.share("view", partial(_current, studio, event.data["id"]))


async def _current(studio: Studio, job_id: str) -> JobView | None:
    """Return how the job stands now; None when its clip was deleted meanwhile."""
    try:
        job = await run_in_threadpool(studio.jobs.get, job_id)
    except NotFound:
        return None
    return view_job(job, studio.runner.progress(job_id))


def _event(view: JobView | None) -> ServerSentEvent:
    if view is None:
        return ServerSentEvent(data='{"status": "cancelled"}', id=FINAL_EVENT_ID)
    final = view.status.final
    return ServerSentEvent(data=view.model_dump_json(), id=FINAL_EVENT_ID if final else None)
