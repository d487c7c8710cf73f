"""Checks: the health report of a language, computed once a revision, with progress and cancel."""

from __future__ import annotations

from functools import lru_cache
from threading import Lock
from typing import Annotated, Any

from fastapi import APIRouter, Header, Response

from app import __version__
from app.api.http.problems import ProblemError, documented
from app.api.middleware.shutdown import stopping
from app.api.routes.languages import Revision
from app.api.services.context import CurrentStudio
from app.recognition import Language
from app.recognition.health.check import Progress, check_health

CACHED_REPORTS = 64
"""Reports kept ready: one of twenty gestures is about a hundred kilobytes of Python objects."""

TOLD_EVERY = 8
"""Pieces of work, each a take or a movement of some ten milliseconds, between two words about the
progress: ten a second are as smooth as a bar need be."""

router = APIRouter(prefix="/languages", tags=["languages"])


@router.get(
    "/{language_id}/check",
    responses={
        **documented(404, 409),
        200: {"description": "The health report"},
        304: {"description": "The report that the caller has is still the newest"},
    },
)
def check_language(
    language_id: str,
    studio: CurrentStudio,
    response: Response,
    revision: Revision = None,
    if_none_match: Annotated[
        str | None, Header(description="The ETag of a report that the caller has")
    ] = None,
) -> Any:
    """Predict what will be confused, missed or set off by accident, and what would help.

    The first call for a revision takes seconds, further ones none. How far it is comes as `checks`
    among the events; `DELETE` cancels it, which is answered here by 409.
    """
    state = studio.languages.get(language_id, revision)
    # Another version of the recogniser may judge the same revision otherwise.
    tag = f'"{state.revision.revision}-{__version__}"'
    if if_none_match is not None and tag in {each.strip() for each in if_none_match.split(",")}:
        return Response(status_code=304, headers={"ETag": tag})
    response.headers["ETag"] = tag

    def tell(stage: str, done: int, total: int) -> None:
        if studio.stopping.is_set():
            raise stopping()
        if done % TOLD_EVERY == 1:
            told = {"revision": state.revision.revision, "stage": stage, "done": done}
            studio.broadcast.publish("checks", id=language_id, **told, total=total)

    return _check(state.revision.document).report(tell)


@router.delete("/{language_id}/check", status_code=204, responses=documented(404))
def cancel_check(language_id: str, studio: CurrentStudio, revision: Revision = None) -> Response:
    """Cancel the check of a revision, for all who wait for it; does nothing where none runs."""
    _check(studio.languages.get(language_id, revision).revision.document).cancel()
    return Response(status_code=204)


class _Check:
    """One revision's report: whoever asks while it is being computed waits for it."""

    def __init__(self, document: str) -> None:
        self._document = document
        self._lock = Lock()
        self._cancelled = 0  # how often: who waits since before one of them is told so
        self._report: dict[str, Any] | None = None

    def report(self, tell: Progress) -> dict[str, Any]:
        begun = self._cancelled

        def progress(stage: str, done: int, total: int) -> None:
            self._require_wanted(begun)
            tell(stage, done, total)

        with self._lock:
            if self._report is None:
                self._require_wanted(begun)
                language = Language.from_json(self._document)
                self._report = check_health(language, progress=progress).to_dict()
            return self._report

    def cancel(self) -> None:
        self._cancelled += 1

    def _require_wanted(self, begun: int) -> None:
        if self._cancelled != begun:
            detail = "the check was cancelled; ask again to start it anew"
            raise ProblemError(409, "check_cancelled", detail)


@lru_cache(CACHED_REPORTS)
def _check(document: str) -> _Check:
    return _Check(document)
