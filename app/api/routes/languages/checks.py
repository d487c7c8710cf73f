"""Routes of the health report: one job per revision, with progress events and cancel."""

from __future__ import annotations

import hashlib
import json
from typing import Annotated, Any

from fastapi import APIRouter, Header, Request, Response
from starlette.concurrency import run_in_threadpool

from app import __version__
from app.api.http.connection import while_connected
from app.api.http.problems import ProblemError, problem_responses
from app.api.http.revisions import Revision
from app.api.jobs.check import CheckJob
from app.api.jobs.job import JobCancelled
from app.api.middleware.shutdown import stopping
from app.api.services.demonstration_sources import find_sources
from app.api.services.running_studio import CurrentStudio, Studio
from app.api.services.salute_ranges import faults_of_language
from app.api.workers.worker_messages import Failed
from app.recognition.health.finding import Finding
from app.store import LanguageState

router = APIRouter(prefix="/languages", tags=["languages"])


@router.get(
    "/{language_id}/check",
    responses={
        **problem_responses(404, 409),
        200: {"description": "The health report"},
        304: {"description": "The report that the caller has is still the newest"},
    },
)
async def check_language(
    request: Request,
    language_id: str,
    studio: CurrentStudio,
    response: Response,
    revision: Revision = None,
    if_none_match: Annotated[
        str | None, Header(description="The ETag of a report that the caller has")
    ] = None,
) -> Any:
    """Return what other people will reach with a language, and what is wrong with it.

    The first call for a revision takes seconds, further ones none. Its progress comes as `checks`
    among the events; `DELETE` cancels it, which is answered here by 409. It ends when everybody
    who asked for it has left.
    """
    state = await run_in_threadpool(studio.languages.get, language_id, revision)
    faults = await run_in_threadpool(_find_faults, studio, state)
    # Another version of the recogniser may give another report for the same revision, and clips
    # come and go, with the faults that they show.
    shown = hashlib.sha256(json.dumps(faults).encode()).hexdigest()[:16]
    tag = f'"{state.revision.revision}-{__version__}-{shown}"'
    if if_none_match is not None and tag in {each.strip() for each in if_none_match.split(",")}:
        return Response(status_code=304, headers={"ETag": tag})
    response.headers["ETag"] = tag
    try:
        report = await while_connected(request, studio.runner.run(_job(state, studio)))
    except JobCancelled as error:
        raise _refusal(studio) from error
    if isinstance(report, Failed):
        raise ProblemError(422, report.code, report.detail)
    warnings = [*faults, *report["warnings"]]
    return report | {"ok": report["ok"] and not faults, "warnings": warnings}


@router.delete("/{language_id}/check", status_code=204, responses=problem_responses(404))
async def cancel_check(
    language_id: str, studio: CurrentStudio, revision: Revision = None
) -> Response:
    """Cancel the check of a revision, for all who wait for it; does nothing where none runs."""
    state = await run_in_threadpool(studio.languages.get, language_id, revision)
    await studio.runner.cancel(_job(state, studio).key)
    return Response(status_code=204)


def _job(state: LanguageState, studio: Studio) -> CheckJob:
    return CheckJob(
        state.record.id,
        state.revision.revision,
        state.revision.document,
        studio.workers,
        studio.clips.folder,
    )


def _find_faults(studio: Studio, state: LanguageState) -> list[dict[str, Any]]:
    """Return the faults of demonstrations whose clips are known, as findings."""
    language = studio.language(state)
    known = faults_of_language(studio, language, find_sources(studio, language))
    return [
        Finding("demonstration_fault", (label,), faults[0].describe(label), True).to_dict()
        for label, demonstrations in known.items()
        for faults in demonstrations
        if faults
    ]


def _refusal(studio: Studio) -> ProblemError:
    if studio.stopping.is_set():
        return stopping()
    detail = "the check was cancelled; ask again to start it anew"
    return ProblemError(409, "check_cancelled", detail)
