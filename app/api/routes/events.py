"""Route of the event stream: server-sent events about every change, one stream per page."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from functools import partial

from fastapi import APIRouter
from sse_starlette import EventSourceResponse, ServerSentEvent

from app.api.events.broadcast import Event
from app.api.http.problems import problem_responses
from app.api.routes.clips.extraction_jobs import EVENT_STREAM, current_view
from app.api.services.running_studio import CurrentStudio, Studio

router = APIRouter(prefix="/events", tags=["events"])

RETRY_MILLISECONDS = 1000
"""Time after which a page connects again; `core/server-events.js` has the same."""


@router.get(
    "", response_class=EventSourceResponse, responses={**problem_responses(), **EVENT_STREAM}
)
async def follow_changes(studio: CurrentStudio) -> EventSourceResponse:
    """Stream what changes, as server-sent events.

    `clips`, `languages` and `recognitions` carry the `id` to load again, `jobs` the whole job,
    `checks` how far the check of a language is, `exports` how far a bag is,
    `tables` how far a table of takes is.
    One stream for all, because browsers open only six connections to a server.
    """
    return EventSourceResponse(_change_events(studio))


async def _change_events(studio: Studio) -> AsyncIterator[ServerSentEvent]:
    with studio.broadcast.subscribe() as events:
        yield ServerSentEvent(comment="listening", retry=RETRY_MILLISECONDS)
        async for event in events:
            text = await event.share("text", partial(_write_text, studio, event))
            yield ServerSentEvent(data=text, event=event.kind)


async def _write_text(studio: Studio, event: Event) -> str:
    if event.kind == "jobs" and (view := await current_view(studio, event)) is not None:
        return view.model_dump_json()
    return json.dumps(event.data)
