"""Route of the table of takes: all takes of several clips, recognised by one language."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Annotated
from uuid import uuid4

from fastapi import APIRouter, Request
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import ProblemError, problem_of, problem_responses
from app.api.http.schemas.values import Body, Identifier, View
from app.api.jobs.job import Job, Report, TimeLeft, compute_in_place, events_about
from app.api.routes.asked_revisions import NewestRevision
from app.api.routes.awaited_jobs import await_job
from app.api.services.demonstration_sources import SAME_TAKE, find_takes
from app.api.services.recording_cache import recording_of
from app.api.services.running_studio import CurrentStudio, Studio
from app.api.services.stored_languages import language_of, recognizer_of
from app.api.services.stored_recognitions import require_landmarks_of
from app.api.workers.worker_messages import Progress
from app.evaluation.confusion import NONE
from app.evaluation.take_table import Row, row_of_fault, rows_of_clip, write_csv
from app.recognition import OsgError, Recognition, Take
from app.recognition.recording.clip_range import SAME_MOMENT, find_unseen_in
from app.recognition.recording.segmentation import find_brackets
from app.store import Clip, ClipStore, LabelledTake, LabelledTakeStore, LanguageState, StoreError

MOST_CLIPS = 500
"""Most clips of one table."""


class TakeTableRequest(Body):
    """Clips whose takes are recognised."""

    id: Identifier
    """Chosen by the client: names its `tables` events."""
    clip_ids: Annotated[list[Identifier], Field(min_length=1, max_length=MOST_CLIPS)]


class TakeRowView(View):
    """A take, or a clip without one, as `osg-studio recognize FOLDER --table` writes it."""

    clip_id: str
    clip: str
    take: int | None
    """From 1; null: no take was found, see `faults`."""
    start: float | None
    end: float | None
    closed: bool | None
    label: str | None
    """Null: a pair, or rejected."""
    nearest: str | None
    runner_up: str | None
    """The nearest gesture but `nearest`."""
    confidence: float | None
    margin: float | None
    expected: str | None
    """By the language's test set; null: not in it; ``-``: none of the gestures."""
    faults: str
    language: str
    revision: int
    profile: str
    pair: str | None
    """"circle or square"; null: it lies between no two."""


class TakeTableView(View):
    """One row for each take, clip after clip."""

    rows: list[TakeRowView]
    csv: str
    """The same rows as the command line writes them."""


router = APIRouter(prefix="/languages/{language_id}/take-table", tags=["languages"])


@router.post("", responses=problem_responses(404))
async def make_take_table(
    request: Request, asked: NewestRevision, wanted: TakeTableRequest, studio: CurrentStudio
) -> TakeTableView:
    """Recognise all takes of clips, and return one table; nothing is kept.

    How far it is comes as `tables` among the events; closing the request cancels it.
    """
    recognize = partial(recognize_clip_takes, studio, await run_in_threadpool(lambda: asked.state))
    clips = await run_in_threadpool(
        lambda: [studio.clips.get(clip_id).clip for clip_id in wanted.clip_ids]
    )
    job = take_table_job(wanted.id, clips, recognize, studio.turns.computations)
    rows = await await_job(request, studio.runner, job)
    return TakeTableView(rows=[TakeRowView(**row) for row in rows], csv=write_csv(rows))


def take_table_job(
    table_id: str,
    clips: Sequence[Clip],
    recognize: Callable[[Clip, Callable[[float], None]], list[Row]],
    places: asyncio.Semaphore,
) -> Job[list[Row]]:
    """Return a job that recognises one clip after the other; every table is a job of its own.

    Parameters
    ----------
    table_id
        Id of the table in its events.
    clips
        The clips, in the order of the rows.
    recognize
        Returns the rows of one clip; reports the share of its takes that is done to its callback.
    places
        Limits the computations that run at the same time; further ones wait.

    """

    async def run(report: Report) -> list[Row]:
        rows: list[Row] = []
        left, done = TimeLeft(), 0
        sizes = [max(1, clip.frames or 0) for clip in clips]
        for at, (clip, size) in enumerate(zip(clips, sizes, strict=True), start=1):
            stage, before = f"clip {at} of {len(sizes)}: {clip.name}", done

            def advance(share: float, stage: str = stage, before: int = before) -> None:
                frames = before + round(share * size)  # noqa: B023  # called in this turn alone
                eta = left.estimate(frames, sum(sizes), time.monotonic())
                report(Progress(stage=stage, done=frames, total=sum(sizes), eta_s=eta))

            advance(0.0)
            rows += await compute_in_place(places, partial(recognize, clip, advance))
            done += size
        return rows

    key = f"table {table_id} {uuid4().hex}"
    return Job("take_table", key, events_about("tables", id=table_id), run)


def recognize_clip_takes(
    studio: Studio, state: LanguageState, clip: Clip, advance: Callable[[float], None]
) -> list[Row]:
    """Recognise every take of a clip, and return its rows with the clip's id.

    A clip that cannot be recognised is a row with its fault.

    Parameters
    ----------
    studio, state
        Running studio, and the revision of the language.
    clip
        The clip.
    advance
        Called with the share of takes that are done; an exception in it ends the work.

    """
    recognizer = recognizer_of(state)
    try:
        recording = recording_of(studio.clips, clip.id)
        require_landmarks_of(clip, recording.poses, recognizer.language)
        takes = _list_takes(studio.clips, state, clip)
        results: list[tuple[Take, Recognition]] = []
        for take in takes:
            results.append((take, recognizer.recognize_take(take)))
            advance(len(results) / len(takes))
        expected = _find_expected(studio.labelled, state, clip, takes)
        rows = rows_of_clip(clip.name, recognizer, recording, results, expected)
    except (OsgError, ProblemError, StoreError) as error:
        rows = [row_of_fault(clip.name, recognizer, problem_of(error).detail)]
    return [row | {"clip_id": clip.id} for row in rows]


def _list_takes(clips: ClipStore, state: LanguageState, clip: Clip) -> list[Take]:
    """Return the takes that the studio shows for a clip, with their strokes."""
    recording, trigger = recording_of(clips, clip.id), language_of(state).trigger
    poses, brackets = recording.poses, find_brackets(recording, trigger)
    # Spotted takes get the margin of a range that a person chooses.
    margin = SAME_MOMENT if trigger.spots else 0.0
    return [
        Take(
            start=found.start,
            end=found.end,
            closed=found.closed,
            poses=poses.between(found.stroke_start - margin, found.stroke_end + margin),
            stroke_start=found.stroke_start,
            stroke_end=found.stroke_end,
            untrimmed=poses.between(found.start, found.end),
            unseen=find_unseen_in(poses, brackets, found.start, found.end),
        )
        for found in find_takes(clips, clip.id, state)
    ]


def _find_expected(
    labelled: LabelledTakeStore, state: LanguageState, clip: Clip, takes: list[Take]
) -> dict[int, str]:
    """Return the gesture that the language's test set expects, by number of the take."""
    tested = [each.take for each in labelled.of(state.record.id) if each.take.clip_id == clip.id]
    return {
        number: known.expected or NONE
        for number, take in enumerate(takes, start=1)
        for known in tested
        if _is_same(take, known)
    }


def _is_same(take: Take, known: LabelledTake) -> bool:
    shared = min(take.end, known.end) - max(take.start, known.start)
    return shared > SAME_TAKE * max(take.end - take.start, known.end - known.start)
