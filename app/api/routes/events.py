"""Route of the event stream: server-sent events about every change, one stream per page."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from typing import Any

from fastapi import APIRouter
from sse_starlette import EventSourceResponse, ServerSentEvent
from starlette.concurrency import run_in_threadpool

from app.api.events.broadcast import Event
from app.api.http.problems import problem_responses
from app.api.routes.jobs import EVENT_STREAM, view_job
from app.api.services.studio import CurrentStudio, Studio
from app.store import NotFound

router = APIRouter(prefix="/events", tags=["events"])


@router.get(
    "", response_class=EventSourceResponse, responses={**problem_responses(), **EVENT_STREAM}
)
async def follow_changes(studio: CurrentStudio) -> EventSourceResponse:
    """Stream what changes, as server-sent events.

    `clips`, `languages` and `recognitions` carry the `id` to load again, `jobs` the whole job,
    `checks` how far the check of a language is, `exports` how far a session's file is.
    One stream for all, because browsers open only six connections to a server.
    """
    return EventSourceResponse(_change_events(studio))


async def _change_events(studio: Studio) -> AsyncIterator[ServerSentEvent]:
    with studio.broadcast.subscribe() as events:
        yield ServerSentEvent(comment="listening", retry=1000)
        async for event in events:
            content = await _content(studio, event)
            yield ServerSentEvent(data=json.dumps(content), event=event.kind)


async def _content(studio: Studio, event: Event) -> dict[str, Any]:
    if event.kind != "jobs":
        return event.data
    try:
        job = await run_in_threadpool(studio.jobs.get, event.data["id"])
    except NotFound:
        return event.data
    view = view_job(job, studio.runner.progress(job.id))
    content: dict[str, Any] = view.model_dump(mode="json")
    return content
