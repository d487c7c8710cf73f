"""Route of the list of clips, whole or in pages."""

from __future__ import annotations

from typing import Annotated, Final
from urllib.parse import urlencode

from fastapi import APIRouter, Query, Response
from pydantic import BaseModel, Field, TypeAdapter

from app.api.http.list_responses import NOT_SENT_AGAIN, KnownTags, list_response
from app.api.http.problems import problem_responses
from app.api.http.schemas.clips import ClipView
from app.api.services.clip_responses import view_clip
from app.api.services.running_studio import Clips
from app.recognition.text.described import DESCRIBED
from app.store import ClipQuery, ClipStore, JobStatus

MOST_LISTED: Final = 1000
"""Most clips of a page, fewer than the values that a statement of SQLite can have."""

LONGEST_NAME: Final = 200
"""Most characters of a clip's name."""

KEPT_PAGES: Final = 16
"""Number of serialised pages kept: browsers begin with the same one, and each has half a
megabyte."""

PAGE_HEADERS: Final = {
    "Link": {
        "description": 'With `limit`: the address of the next page, `rel="next"`; not on the last',
        "schema": {"type": "string"},
    },
    "X-Total-Count": {
        "description": "With `limit` alone: the number of all clips",
        "schema": {"type": "integer"},
    },
}

ClipId = Annotated[str, Field(max_length=64)]

router = APIRouter(prefix="/clips", tags=["clips"])


class ListedClips(BaseModel):
    """Which clips are listed."""

    model_config = DESCRIBED

    limit: Annotated[int | None, Field(ge=1, le=MOST_LISTED)] = None
    """Most clips; by default all of them."""
    after: ClipId | None = None
    """The id of the last clip of the page before."""
    q: Annotated[str, Field(max_length=LONGEST_NAME)] = ""
    """What their names contain, in any case."""
    status: list[JobStatus] | None = None
    """Where their jobs stand; may be repeated."""
    id: Annotated[list[ClipId] | None, Field(max_length=MOST_LISTED)] = None
    """Only these clips; may be repeated."""


@router.get(
    "",
    response_model=list[ClipView],
    responses={
        **problem_responses(404),
        **NOT_SENT_AGAIN,
        200: {"description": "The clips", "headers": PAGE_HEADERS},
    },
)
def list_clips(clips: Clips, known: KnownTags, wanted: Annotated[ListedClips, Query()]) -> Response:
    """List the clips, newest first: all of them, or a page of those that are asked for."""
    chosen = tuple(wanted.status or ()), tuple(wanted.id or ())
    query = ClipQuery(wanted.limit or MOST_LISTED, wanted.after, wanted.q.strip(), *chosen)
    if wanted.limit is None and query == ClipQuery(MOST_LISTED):
        return _listed(clips, known, None)
    return _listed(clips, known, query)


def read_page(clips: ClipStore, query: ClipQuery | None) -> tuple[list[ClipView], dict[str, str]]:
    """Return the clips of a page, and the headers that state its position; all without a query."""
    if query is None:
        return [view_clip(found) for found in clips.all()], {}
    page, headers = clips.page(query), {}
    if page.more:
        headers["Link"] = f'<?{_write_query(query, page.clips[-1].clip.id)}>; rel="next"'
    if query == ClipQuery(query.limit):
        headers["X-Total-Count"] = str(clips.count())
    return [view_clip(found) for found in page.clips], headers


def _write_query(query: ClipQuery, after: str) -> str:
    """Return the query of the address of the page that follows the clip `after`."""
    given = {
        "q": query.name,
        "status": [status.value for status in query.statuses],
        "id": query.ids,
        "limit": query.limit,
        "after": after,
    }
    return urlencode({name: value for name, value in given.items() if value}, doseq=True)


_listed = list_response(read_page, TypeAdapter(list[ClipView]), KEPT_PAGES)
