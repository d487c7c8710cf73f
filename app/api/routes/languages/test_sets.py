"""Routes of a language's test set: labelled takes, recognised again after every change."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import ProblemError, problem_responses
from app.api.ingest.intake import SenderQuota
from app.api.routes.asked_revisions import NewestRevision
from app.api.routes.awaited_jobs import await_job
from app.api.services.running_studio import CurrentStudio, Runner, Studio
from app.api.services.stored_languages import language_of
from app.api.services.test_sets import (
    LabelledTakeChange,
    LabelledTakesDraft,
    TestSetView,
    add_labelled,
    test_run_key,
    test_run_of,
    view_test_set,
)
from app.api.workers.worker_messages import Failed
from app.store import LanguageState

CANCELLED = "the test run was cancelled; what is done is kept, start it again for the rest"

router = APIRouter(prefix="/languages/{language_id}/test-set", tags=["languages"])


@router.get("", responses=problem_responses(404))
def get_test_set(asked: NewestRevision, studio: CurrentStudio) -> TestSetView:
    """Return the labelled takes of a language, how each is recognised, and the rates."""
    return view_test_set(studio, asked.state)


@router.post("", status_code=201, responses=problem_responses(404, 409))
def add_labelled_takes(
    asked: NewestRevision, draft: LabelledTakesDraft, studio: CurrentStudio, quota: SenderQuota
) -> TestSetView:
    """Add takes with the gesture that each shows; `POST .../run` recognises them."""
    add_labelled(studio, asked.state, draft.takes, quota.owner)
    return _changed(studio, asked.state)


@router.post("/run", responses=problem_responses(404, 409))
async def run_test_set(
    request: Request, asked: NewestRevision, studio: CurrentStudio
) -> TestSetView:
    """Recognise the takes that the newest revision has not recognised yet.

    Its progress comes as `tests` among the events. It goes on when the client leaves; `DELETE`
    cancels it, which is answered here by 409, and keeps what is done.
    """
    state = await run_in_threadpool(lambda: asked.state)
    if (job := await run_in_threadpool(test_run_of, studio, state)) is not None:
        cancelled = ProblemError(409, "test_run_cancelled", CANCELLED)
        ended = await await_job(request, studio.runner, job, cancelled)
        if isinstance(ended, Failed):
            raise ProblemError(422, ended.code, ended.detail)
    return await run_in_threadpool(_changed, studio, state)


@router.delete("/run", status_code=204, responses=problem_responses(404))
async def cancel_test_run(asked: NewestRevision, runner: Runner) -> Response:
    """Cancel the run of the newest revision, for all who wait for it."""
    state = await run_in_threadpool(lambda: asked.state)
    await runner.cancel(test_run_key(asked.language_id, state.revision.revision))
    return Response(status_code=204)


@router.patch("/{take_id}", responses=problem_responses(404))
def label_take(
    language_id: str, take_id: str, change: LabelledTakeChange, studio: CurrentStudio
) -> TestSetView:
    """Give a take another label."""
    state = studio.languages.get(language_id)
    studio.labelled.label(language_id, take_id, language_of(state).spell(change.stored))
    return _changed(studio, state)


@router.delete("/{take_id}", responses=problem_responses(404))
def remove_labelled_take(language_id: str, take_id: str, studio: CurrentStudio) -> TestSetView:
    """Take a take out of the test set; its clip stays."""
    state = studio.languages.get(language_id)
    studio.labelled.remove(language_id, take_id)
    return _changed(studio, state)


def _changed(studio: Studio, state: LanguageState) -> TestSetView:
    """Publish the change to the open pages, and return the test set."""
    studio.broadcast.publish("test-sets", id=state.record.id)
    return view_test_set(studio, state)
