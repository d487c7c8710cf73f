"""Routes of the health report: one job per revision, with progress events and cancel."""

from __future__ import annotations

import hashlib
import json
from functools import lru_cache, partial
from typing import Any

from fastapi import APIRouter, Request, Response
from starlette.concurrency import run_in_threadpool

from app import __version__
from app.api.http.list_responses import KnownTags
from app.api.http.problems import ProblemError, problem_responses
from app.api.jobs.job import Job, events_about, run_task
from app.api.routes.asked_revisions import CurrentRevision
from app.api.routes.awaited_jobs import await_job
from app.api.services.demonstration_sources import faults_of_language
from app.api.services.known_takes import list_known, load_known
from app.api.services.running_studio import Studio
from app.api.services.test_sets import list_tested
from app.api.workers.tasks import Check
from app.api.workers.worker_messages import Failed, Finished
from app.recognition import Recognizer
from app.recognition.explanation.blame import find_blame
from app.recognition.explanation.context import KnownTakes
from app.recognition.health.finding import Finding, Verdict
from app.store import LanguageState

CANCELLED = "the check was cancelled; ask again to start it anew"

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
    asked: CurrentRevision,
    response: Response,
    known: KnownTags,
) -> Any:
    """Return what other people will reach with a language, and what is wrong with it.

    Its `verdict` also tells what the test set has shown of the gestures.

    The first call for a revision takes seconds, further ones none. Its progress comes as `checks`
    among the events; `DELETE` cancels it, which is answered here by 409. It ends when everybody
    who asked for it has left.
    """
    studio, state = asked.studio, await run_in_threadpool(lambda: asked.state)
    faults = await run_in_threadpool(_find_faults, studio, state)
    tested = await run_in_threadpool(list_tested, studio, state)
    # Another version of the recogniser may give another report for the same revision; clips come
    # and go, with the faults that they show, and so do takes of the test set.
    seen = json.dumps([faults, [vars(each) for each in tested]])
    shown = hashlib.sha256(seen.encode()).hexdigest()[:16]
    tag = f'"{state.revision.revision}-{__version__}-{shown}"'
    if tag in known:
        return Response(status_code=304, headers={"ETag": tag})
    response.headers["ETag"] = tag
    cancelled = ProblemError(409, "check_cancelled", CANCELLED)
    ended = await await_job(request, studio, _job(state, studio), cancelled)
    if isinstance(ended, Failed):
        raise ProblemError(422, ended.code, ended.detail)
    report = ended.result
    warnings = [*faults, *report["warnings"]]
    errors = sum(warning["error"] for warning in warnings)
    # A test may have ended during the check.
    tested = await run_in_threadpool(list_tested, studio, state)
    verdict = Verdict.of(errors, studio.language(state).labels, tested)
    return report | {"ok": not errors, "warnings": warnings, "verdict": verdict.to_dict()}


@router.delete("/{language_id}/check", status_code=204, responses=problem_responses(404))
async def cancel_check(asked: CurrentRevision) -> Response:
    """Cancel the check of a revision, for all who wait for it; does nothing where none runs."""
    state = await run_in_threadpool(lambda: asked.state)
    await asked.studio.runner.cancel(_job(state, asked.studio).key)
    return Response(status_code=204)


def _job(state: LanguageState, studio: Studio) -> Job[Finished | Failed]:
    """Return the check of a revision: the same document gives the same report."""
    document = state.revision.document
    key = f"check {hashlib.sha256(document.encode()).hexdigest()}"
    event = events_about("checks", id=state.record.id, revision=state.revision.revision)
    run = partial(run_task, studio.workers, Check(document=document))
    return Job("check", key, event, run, cached=True)


def _find_faults(studio: Studio, state: LanguageState) -> list[dict[str, Any]]:
    """Return the faults of demonstrations as findings, by their clips and by the known takes."""
    language = studio.language(state)
    known = faults_of_language(studio, language)
    told = [
        (label, faults[0].describe(label))
        for label, demonstrations in known.items()
        for faults in demonstrations
        if faults
    ]
    seen = {label for label, _ in told}
    told += [each for each in _blame(studio, state) if each[0] not in seen]
    return [
        Finding("demonstration_fault", (label,), sentence, True).to_dict()
        for label, sentence in told
    ]


CACHED_BLAME = 64
"""Revisions, each with its known takes, of which it is known which demonstrations they blame."""


def _blame(studio: Studio, state: LanguageState) -> tuple[tuple[str, str], ...]:
    """Return gesture and sentence of each demonstration that the known takes blame."""
    takes = list_known(studio, state.record.id)
    ranges = tuple((each.clip_id, each.start, each.expected) for each in takes)
    return _blame_by(studio, state.record.id, state.revision.revision, ranges) if takes else ()


@lru_cache(CACHED_BLAME)
def _blame_by(
    studio: Studio, language_id: str, revision: int, _takes: tuple[tuple[str, float, str], ...]
) -> tuple[tuple[str, str], ...]:
    """Find the same; the known takes distinguish the states of the test set in the cache."""
    language = studio.language(studio.languages.get(language_id, revision))
    if not language.gestures:
        return ()
    recognizer = Recognizer(language, "full")
    known = list(load_known(studio, language_id, recognizer))
    found = find_blame(KnownTakes(recognizer, known))
    return tuple((each.label, each.sentence) for each in found)
