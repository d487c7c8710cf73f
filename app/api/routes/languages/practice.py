"""Routes of practice: a diver shows a gesture, learns what to change, and is kept a record of."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter
from pydantic import Field

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.gestures import RecognitionRequest
from app.api.http.schemas.values import Body, Diver, Identifier, Label, Seconds, View
from app.api.ingest.intake import SenderQuota
from app.api.routes.asked_revisions import NewestRevision
from app.api.services.gesture_edits import gesture_in
from app.api.services.limited_routes import edited
from app.api.services.running_studio import CurrentStudio, Languages, Practice
from app.api.services.stored_recognitions import (
    load_context,
    load_recognition,
    recognize_range,
    write_notes,
)
from app.evaluation.error_rate_bound import CONFIDENCE, LIMIT, bound_error_rate, count_takes_needed
from app.recognition.decision.result import Pair
from app.recognition.explanation.causes import Cause
from app.recognition.explanation.explanation import explain
from app.store import LanguageState, PracticeStore, PracticeTake

router = APIRouter(prefix="/languages/{language_id}/practice", tags=["languages"])


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


@router.get("", responses=problem_responses(404))
def list_records(asked: NewestRevision, practice: Practice) -> list[PracticeRecordView]:
    """Return the record of every diver."""
    return _records(practice, asked.state)


@router.post("", status_code=201, responses=problem_responses(404, 409))
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
    take = studio.practice.keep(
        PracticeTake(
            language_id=asked.language_id,
            clip_id=draft.clip_id,
            start=record.start,
            diver=draft.diver.strip(),
            expected=expected,
            label=answer.label,
            pair=None if answer.pair is None else [*answer.pair],
            revision=record.revision,
            recognition_id=record.id,
            added_by=quota.owner,
        )
    )
    why = explain(load_context(record, studio), expected, with_counterfactuals=False)
    records = _records(studio.practice, asked.state)
    return PracticeAnswerView(
        take=_view(take),
        sentence=why.sentence,
        details=list(why.details),
        causes=list(why.causes),
        notes=[] if why.right else write_notes(studio.demonstrations, record, language),
        record=next(each for each in records if each.diver == take.diver),
    )


@router.delete("/{take_id}", responses=problem_responses(404))
def remove_take(
    language_id: str, take_id: str, languages: Languages, practice: Practice
) -> list[PracticeRecordView]:
    """Remove a take that was no attempt, such as a wrong clip."""
    state = languages.get(language_id)
    practice.remove(language_id, take_id)
    return _records(practice, state)


def _records(practice: PracticeStore, state: LanguageState) -> list[PracticeRecordView]:
    by_diver: dict[str, list[PracticeTake]] = {}
    for take in practice.of(state.record.id):
        by_diver.setdefault(take.diver, []).append(take)
    return [
        _record(diver, takes, state.revision.revision) for diver, takes in sorted(by_diver.items())
    ]


def _record(diver: str, takes: list[PracticeTake], revision: int) -> PracticeRecordView:
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
        shown=[_view(take) for take in takes],
    )


def _view(take: PracticeTake) -> PracticeTakeView:
    shown = take.model_dump(exclude={"language_id", "start", "diver", "created"})
    right = take.label == take.expected
    return PracticeTakeView(**shown, right=right)
