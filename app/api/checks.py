"""Checks: the health report of a language, computed once a revision."""

from __future__ import annotations

from functools import lru_cache
from threading import Lock
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Response

from app import __version__
from app.api.problems import documented
from app.api.studio import CurrentStudio
from app.recognition import Language
from app.recognition.health import check_health

CACHED_REPORTS = 64
"""Reports kept ready: one of twenty gestures is about a hundred kilobytes of Python objects."""

router = APIRouter(prefix="/languages", tags=["languages"])


@router.get(
    "/{language_id}/check",
    responses={
        **documented(404),
        200: {"description": "The health report"},
        304: {"description": "The report that the caller has is still the newest"},
    },
)
def check_language(
    language_id: str,
    studio: CurrentStudio,
    response: Response,
    revision: Annotated[int | None, Query(ge=0, le=2**31 - 1)] = None,
    if_none_match: Annotated[
        str | None, Header(description="The ETag of a report that the caller has")
    ] = None,
) -> Any:
    """Predict what will be confused, missed or set off by accident, and what would help.

    The first call for a revision takes seconds, further ones none.
    """
    state = studio.languages.get(language_id, revision)
    # Another version of the recogniser may judge the same revision otherwise.
    tag = f'"{state.revision.revision}-{__version__}"'
    if if_none_match is not None and tag in {each.strip() for each in if_none_match.split(",")}:
        return Response(status_code=304, headers={"ETag": tag})
    response.headers["ETag"] = tag
    return _check(state.revision.document).report()


class _Check:
    """One revision's report: whoever asks while it is being computed waits for it."""

    def __init__(self, document: str) -> None:
        self._document = document
        self._lock = Lock()
        self._report: dict[str, Any] | None = None

    def report(self) -> dict[str, Any]:
        with self._lock:
            if self._report is None:
                self._report = check_health(Language.from_json(self._document)).to_dict()
            return self._report


@lru_cache(CACHED_REPORTS)
def _check(document: str) -> _Check:
    return _Check(document)
