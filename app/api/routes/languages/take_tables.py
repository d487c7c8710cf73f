"""Route of the table of takes: all takes of several clips, recognised by one language."""

from __future__ import annotations

from functools import partial

from fastapi import APIRouter, Request
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import problem_responses
from app.api.http.schemas.take_tables import TakeRowView, TakeTableRequest, TakeTableView
from app.api.routes.awaited_jobs import await_job
from app.api.services.running_studio import CurrentStudio, Studio
from app.api.services.take_tables import recognize_clip_takes, take_table_job
from app.evaluation.take_table import write_csv
from app.store import Clip, LanguageState

router = APIRouter(prefix="/languages/{language_id}/take-table", tags=["languages"])


@router.post("", responses=problem_responses(404))
async def make_take_table(
    request: Request, language_id: str, wanted: TakeTableRequest, studio: CurrentStudio
) -> TakeTableView:
    """Recognise all takes of clips, and return one table; nothing is kept.

    How far it is comes as `tables` among the events; closing the request cancels it.
    """
    state, clips = await run_in_threadpool(_load, studio, language_id, wanted)
    recognize = partial(recognize_clip_takes, studio, state)
    job = take_table_job(wanted.id, clips, recognize, studio.computations)
    rows = await await_job(request, studio, job)
    return TakeTableView(rows=[TakeRowView(**row) for row in rows], csv=write_csv(rows))


def _load(
    studio: Studio, language_id: str, wanted: TakeTableRequest
) -> tuple[LanguageState, list[Clip]]:
    return (
        studio.languages.get(language_id),
        [studio.clips.get(clip_id).clip for clip_id in wanted.clip_ids],
    )
