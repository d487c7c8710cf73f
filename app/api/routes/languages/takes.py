"""Routes of a language's takes: its test set, their table, and practice.

The takes of a test set are recognised again after every change. In practice a diver shows a
gesture, learns what to change, and is kept a record of.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Annotated
from uuid import uuid4

from fastapi import APIRouter, Request, Response
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import ProblemError, problem_of, problem_responses
from app.api.http.schemas.gestures import RecognitionRequest
from app.api.http.schemas.values import Body, Diver, Identifier, Label, Seconds, View
from app.api.ingest.intake import SenderQuota
from app.api.jobs.job import Job, Report, TimeLeft, compute_in_place, events_about
from app.api.routes.asked_revisions import NewestRevision
from app.api.routes.awaited_jobs import await_job
from app.api.services.demonstration_sources import SAME_TAKE, find_takes
from app.api.services.gesture_edits import gesture_in
from app.api.services.limited_routes import edited
from app.api.services.recording_cache import recording_of
from app.api.services.running_studio import CurrentStudio, Runner, Studio
from app.api.services.stored_languages import language_of, recognizer_of
from app.api.services.stored_recognitions import (
    load_context,
    load_recognition,
    recognize_range,
    require_landmarks_of,
    write_notes,
)
from app.api.services.test_sets import (
    LabelledTakeChange,
    LabelledTakesDraft,
    TestSetView,
    add_labelled,
    test_run_key,
    test_run_of,
    view_test_set,
)
from app.api.workers.worker_messages import Failed, Progress
from app.evaluation.confusion import NONE
from app.evaluation.error_rate_bound import CONFIDENCE, LIMIT, bound_error_rate, count_takes_needed
from app.evaluation.take_table import Row, row_of_fault, rows_of_clip, write_csv
from app.recognition import OsgError, Recognition, Take
from app.recognition.decision.result import Pair
from app.recognition.explanation.causes import Cause
from app.recognition.explanation.explanation import explain
from app.recognition.recording.clip_range import SAME_MOMENT, find_unseen_in
from app.recognition.recording.segmentation import find_brackets
from app.store import (
    Clip,
    ClipStore,
    LabelledTake,
    LanguageState,
    PracticeTake,
    StoreError,
    TakeStore,
)

router = APIRouter(prefix="/languages/{language_id}", tags=["languages"])

CANCELLED = "the test run was cancelled; what is done is kept, start it again for the rest"


@router.get("/test-set", responses=problem_responses(404))
def get_test_set(asked: NewestRevision, studio: CurrentStudio) -> TestSetView:
    """Return the labelled takes of a language, how each is recognised, and the rates."""
    return view_test_set(studio, asked.state)


@router.post("/test-set", status_code=201, responses=problem_responses(404, 409))
def add_labelled_takes(
    asked: NewestRevision, draft: LabelledTakesDraft, studio: CurrentStudio, quota: SenderQuota
) -> TestSetView:
    """Add takes with the gesture that each shows; `POST .../run` recognises them."""
    add_labelled(studio, asked.state, draft.takes, quota.owner)
    return _changed(studio, asked.state)


@router.post("/test-set/run", responses=problem_responses(404, 409))
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


@router.delete("/test-set/run", status_code=204, responses=problem_responses(404))
async def cancel_test_run(asked: NewestRevision, runner: Runner) -> Response:
    """Cancel the run of the newest revision, for all who wait for it."""
    state = await run_in_threadpool(lambda: asked.state)
    await runner.cancel(test_run_key(asked.language_id, state.revision.revision))
    return Response(status_code=204)


@router.patch("/test-set/{take_id}", responses=problem_responses(404))
def label_take(
    language_id: str, take_id: str, change: LabelledTakeChange, studio: CurrentStudio
) -> TestSetView:
    """Give a take another label."""
    state = studio.languages.get(language_id)
    studio.takes.label(language_id, take_id, language_of(state).spell(change.stored))
    return _changed(studio, state)


@router.delete("/test-set/{take_id}", responses=problem_responses(404))
def remove_labelled_take(language_id: str, take_id: str, studio: CurrentStudio) -> TestSetView:
    """Take a take out of the test set; its clip stays."""
    state = studio.languages.get(language_id)
    studio.takes.remove(LabelledTake, language_id, take_id)
    return _changed(studio, state)


def _changed(studio: Studio, state: LanguageState) -> TestSetView:
    """Publish the change to the open pages, and return the test set."""
    studio.broadcast.publish("test-sets", id=state.record.id)
    return view_test_set(studio, state)


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


@router.post("/take-table", responses=problem_responses(404))
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
        expected = _find_expected(studio.takes, state, clip, takes)
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
    known: TakeStore, state: LanguageState, clip: Clip, takes: list[Take]
) -> dict[int, str]:
    """Return the gesture that the language's test set expects, by number of the take."""
    tested = [each.take for each in known.tested(state.record.id) if each.take.clip_id == clip.id]
    return {
        number: known.expected or NONE
        for number, take in enumerate(takes, start=1)
        for known in tested
        if _is_same(take, known)
    }


def _is_same(take: Take, known: LabelledTake) -> bool:
    shared = min(take.end, known.end) - max(take.start, known.start)
    return shared > SAME_TAKE * max(take.end - take.start, known.end - known.start)


class PracticeDraft(Body):
    """A gesture that a diver shows in a clip."""

    diver: Annotated[Diver, Field(min_length=1, pattern=r"\S")]
    expected: Label
    clip_id: Identifier
    start: Seconds | None = None
    end: Seconds | None = None


class PracticeTakeView(View):
    """One take of practice."""

    id: str
    expected: str
    label: str | None
    """Null: a pair, or rejected."""
    pair: Pair
    right: bool
    clip_id: str
    recognition_id: str
    revision: int
    added_by: str
    """Name of who added it; empty: not known."""


class PracticeRecordView(View):
    """A diver's record with the newest revision: evidence of acceptance."""

    diver: str
    takes: int
    """Takes recognised by the newest revision, without pairs."""
    errors: int
    pairs: int
    """Takes of the newest revision that were asked back, with the gesture meant in the pair:
    neither right nor an error."""
    bound: float
    """Upper bound of the error rate (Clopper and Pearson)."""
    limit: float
    """Error rate to be below."""
    confidence: float
    """Confidence of the bound."""
    reached: bool
    """Whether the bound is below the limit."""
    more: int
    """Further takes without an error until it is; 0 when reached."""
    older: int
    """Takes with older revisions, which do not count."""
    shown: list[PracticeTakeView]
    """All takes, the newest first."""


class PracticeAnswerView(View):
    """What is said about a take at once."""

    take: PracticeTakeView
    sentence: str
    details: list[str]
    """The numbers behind the sentence."""
    causes: list[Cause]
    """Why, the cause first; empty: none is known."""
    notes: list[str]
    record: PracticeRecordView


@router.get("/practice", responses=problem_responses(404))
def list_records(asked: NewestRevision, studio: CurrentStudio) -> list[PracticeRecordView]:
    """Return the record of every diver."""
    return _view_records(studio, asked.state)


@router.post("/practice", status_code=201, responses=problem_responses(404, 409))
@edited
def show_gesture(
    asked: NewestRevision, draft: PracticeDraft, studio: CurrentStudio, quota: SenderQuota
) -> PracticeAnswerView:
    """Recognise what a diver shows, say what to change, and keep it in the diver's record."""
    language = asked.language
    expected = gesture_in(language, language.spell(draft.expected)).label
    if draft.clip_id in studio.demonstrations.clips_of(language):
        detail = "this clip is a demonstration of the language, which is recognised by construction"
        raise ProblemError(409, "is_demonstration", detail)
    shown = draft.model_dump(exclude={"diver"})
    request = RecognitionRequest(language_id=asked.language_id, **shown)
    record = recognize_range(studio, request, quota)
    answer = load_recognition(record)
    take = PracticeTake(
        **record.model_dump(include={"language_id", "clip_id", "start", "revision"}),
        diver=draft.diver.strip(),
        expected=expected,
        label=answer.label,
        pair=None if answer.pair is None else [*answer.pair],
        recognition_id=record.id,
        added_by=quota.owner,
    )
    studio.takes.practise(take)
    why = explain(load_context(record, studio), expected, with_counterfactuals=False)
    records = _view_records(studio, asked.state)
    return PracticeAnswerView(
        take=_view_practised(take),
        sentence=why.sentence,
        details=list(why.details),
        causes=list(why.causes),
        notes=[] if why.right else write_notes(studio.demonstrations, record, language),
        record=next(each for each in records if each.diver == take.diver),
    )


@router.delete("/practice/{take_id}", responses=problem_responses(404))
def remove_take(language_id: str, take_id: str, studio: CurrentStudio) -> list[PracticeRecordView]:
    """Remove a take that was no attempt, such as a wrong clip."""
    state = studio.languages.get(language_id)
    studio.takes.remove(PracticeTake, language_id, take_id)
    return _view_records(studio, state)


def _view_records(studio: Studio, state: LanguageState) -> list[PracticeRecordView]:
    by_diver: dict[str, list[PracticeTake]] = {}
    for take in studio.takes.practised(state.record.id):
        by_diver.setdefault(take.diver, []).append(take)
    newest = state.revision.revision
    return [_view_record(diver, takes, newest) for diver, takes in sorted(by_diver.items())]


def _view_record(diver: str, takes: list[PracticeTake], revision: int) -> PracticeRecordView:
    current = [take for take in takes if take.revision == revision]
    counted = [take for take in current if take.expected not in (take.pair or ())]
    errors = sum(take.label != take.expected for take in counted)
    bound = bound_error_rate(errors, len(counted))
    return PracticeRecordView(
        diver=diver,
        takes=len(counted),
        errors=errors,
        pairs=len(current) - len(counted),
        bound=bound,
        limit=LIMIT,
        confidence=CONFIDENCE,
        reached=bound < LIMIT,
        more=max(0, count_takes_needed(errors) - len(counted)),
        older=len(takes) - len(current),
        shown=[_view_practised(take) for take in takes],
    )


def _view_practised(take: PracticeTake) -> PracticeTakeView:
    return PracticeTakeView(**take.model_dump(), right=take.label == take.expected)
