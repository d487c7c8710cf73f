"""Routes of what is found out about a language: health report, pair difference, phrases.

The report is one job per revision, with progress events and cancel.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict
from functools import lru_cache, partial
from typing import Annotated, Any, Literal

import numpy as np
from fastapi import APIRouter, Query, Request, Response
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from app import __version__
from app.api.http.list_responses import KnownTags
from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.values import Label, View
from app.api.jobs.job import Job, events_about, run_task
from app.api.routes.asked_revisions import CurrentRevision
from app.api.routes.awaited_jobs import await_job
from app.api.services.gesture_edits import gesture_in
from app.api.services.limited_routes import computed, computed_briefly
from app.api.services.running_studio import CurrentStudio, Studio
from app.api.services.stored_languages import DocumentCache, language_of, recognizer_of
from app.api.services.stored_recognitions import load_known
from app.api.services.test_sets import list_tested
from app.api.workers.tasks import Check
from app.api.workers.worker_messages import Failed, Finished
from app.api.workers.worker_processes import Workers
from app.recognition import Language, Recognizer
from app.recognition.decision.result import Pair
from app.recognition.explanation.alignment import Alignment, PairDifference, compare_pair
from app.recognition.explanation.blame import find_blame
from app.recognition.explanation.context import KnownTakes
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH, Gesture
from app.recognition.health.finding import Finding, Verdict
from app.recognition.health.phrase_ambiguity import AmbiguityKind, find_ambiguities
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.parser import PhraseEvent, PhraseEventKind, PhraseParser
from app.store import LanguageState

MOST_SHOWN = 100
"""Most gestures of one simulation: more than any message may have."""

BETWEEN = "\t"
"""Separates the two labels of a pair; no label has it."""

Shown = Annotated[
    list[Annotated[str, Field(max_length=2 * MAX_LABEL_LENGTH + len(BETWEEN))]],
    Query(
        max_length=MOST_SHOWN,
        description="Labels in order; an empty one was not recognised, two with a tab between "
        "them are a pair",
    ),
]


DIGITS = 3
"""Decimals of places and seconds: a millisecond, and half a millimetre of a diver."""

Place = tuple[float, float] | None
"""Torso lengths from the torso's centre, x right and y down; null where not seen."""


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
    studio: CurrentStudio,
    response: Response,
    known: KnownTags,
) -> Any:
    """Return what other people will reach with a language, and what is wrong with it.

    Its `verdict` also tells what the test set has shown of the gestures.

    The first call for a revision takes seconds, further ones none. Its progress comes as `checks`
    among the events; `DELETE` cancels it, which is answered here by 409. It ends when everybody
    who asked for it has left.
    """
    state = await run_in_threadpool(lambda: asked.state)
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
    ended = await await_job(request, studio.runner, _job(state, studio.workers), cancelled)
    if isinstance(ended, Failed):
        raise ProblemError(422, ended.code, ended.detail)
    report = ended.result
    warnings = [*faults, *report["warnings"]]
    errors = sum(warning["error"] for warning in warnings)
    # A test may have ended during the check.
    tested = await run_in_threadpool(list_tested, studio, state)
    verdict = Verdict.of(errors, state.revision.labels, tested)
    return report | {"ok": not errors, "warnings": warnings, "verdict": verdict.to_dict()}


@router.delete("/{language_id}/check", status_code=204, responses=problem_responses(404))
async def cancel_check(asked: CurrentRevision, studio: CurrentStudio) -> Response:
    """Cancel the check of a revision, for all who wait for it; does nothing where none runs."""
    state = await run_in_threadpool(lambda: asked.state)
    await studio.runner.cancel(_job(state, studio.workers).key)
    return Response(status_code=204)


def _job(state: LanguageState, workers: Workers) -> Job[Finished | Failed]:
    """Return the check of a revision: the same document gives the same report."""
    document = state.revision.document
    key = f"check {hashlib.sha256(document.encode()).hexdigest()}"
    event = events_about("checks", id=state.record.id, revision=state.revision.revision)
    run = partial(run_task, workers, Check(document=document))
    return Job("check", key, event, run, cached=True)


def _find_faults(studio: Studio, state: LanguageState) -> list[dict[str, Any]]:
    """Return the faults of demonstrations as findings, by their clips and by the known takes."""
    known = studio.demonstrations.find_faults(language_of(state))
    told = [
        (label, faults[0].describe(label))
        for label, demonstrations in known.items()
        for faults in demonstrations
        if faults
    ]
    seen = {label for label, _ in told}
    if takes := studio.takes.known(state.record.id):
        ranges = tuple((each.clip_id, each.start, each.expected) for each in takes)
        blamed = _blame_by(studio, state.record.id, state.revision.revision, ranges)
        told += [each for each in blamed if each[0] not in seen]
    return [
        Finding("demonstration_fault", (label,), sentence, True).to_dict()
        for label, sentence in told
    ]


CACHED_BLAME = 64
"""Revisions, each with its known takes, of which it is known which demonstrations they blame."""


@lru_cache(CACHED_BLAME)
def _blame_by(
    studio: Studio, language_id: str, revision: int, _takes: tuple[tuple[str, float, str], ...]
) -> tuple[tuple[str, str], ...]:
    """Return gesture and sentence of each demonstration that the known takes blame.

    The takes distinguish the states of the test set in the cache.
    """
    language = language_of(studio.languages.get(language_id, revision))
    if not language.gestures:
        return ()
    recognizer = Recognizer(language, "full")
    known = list(load_known(studio, language_id, recognizer))
    found = find_blame(KnownTakes(recognizer, known))
    return tuple((each.label, each.sentence) for each in found)


class PathsView(View):
    """A gesture's demonstration, as it is drawn."""

    label: str
    salient: list[str]
    time: list[float]
    """Seconds of each moment."""
    paths: dict[str, list[Place]]
    """Per landmark its place at each moment, torso lengths from the torso's centre."""


class ContrastView(View):
    """Two gestures of a language, and in what they differ."""

    gestures: tuple[PathsView, PathsView]
    differs: tuple[str | None, str | None]
    """In what the first differs from the second, and the second from the first; null where they
    cannot be compared."""
    alignment: Alignment | None
    """Which moment of the first corresponds to which of the second."""


@router.get("/{language_id}/contrast", responses=problem_responses(404))
@computed
def contrast_gestures(
    asked: CurrentRevision,
    advance: Callable[[], None],
    one: Annotated[Label, Query(description="A gesture's label")],
    other: Annotated[Label, Query(description="Another one's")],
) -> ContrastView:
    """Return in what two gestures differ, and which of their moments correspond."""
    recognizer = recognizer_of(asked.state, "full")
    language = recognizer.language
    for label in (one, other):
        gesture_in(language, label)
    first, second = language.labels.index(one), language.labels.index(other)
    advance()
    forth = compare_pair(recognizer, first, second)
    advance()
    back = compare_pair(recognizer, second, first)
    return ContrastView(
        gestures=(_paths(language.gestures[first]), _paths(language.gestures[second])),
        differs=(_words(forth), _words(back)),
        alignment=None if forth is None else forth.alignment,
    )


def _words(found: PairDifference | None) -> str | None:
    return None if found is None else found.words


def _paths(gesture: Gesture) -> PathsView:
    shown = gesture.trajectory
    paths: dict[str, list[Place]] = {}
    time: list[float] = []
    if shown is not None:
        time = np.round(shown.time - shown.time[0], DIGITS).tolist()
        for landmark, places in zip(shown.landmarks, np.moveaxis(shown.xy, 1, 0), strict=True):
            paths[landmark] = [
                (x, y) if np.isfinite((x, y)).all() else None
                for x, y in np.round(places, DIGITS).tolist()
            ]
    return PathsView(label=gesture.label, salient=list(gesture.salient), time=time, paths=paths)


class AmbiguityView(View):
    """Something that the robot could understand in two ways."""

    kind: AmbiguityKind
    phrases: list[str]
    gestures: list[str]
    """The message that shows it."""
    message: str


class MeaningView(View):
    """One phrase of a message."""

    phrase: str
    slots: dict[str, Any]
    command: str | dict[str, Any] | None
    spoken: str


class PhraseEventView(View):
    """What came of one gesture."""

    kind: PhraseEventKind
    gestures: list[str]
    """Of the message so far."""
    label: str | None
    """Null for a pair, when it was not recognised, and for a pause."""
    pair: Pair
    expected: list[str]
    """What may come next."""
    mission: list[MeaningView] | None
    """What to do; only when complete."""
    text: str
    """In words, for the diver."""
    start: float
    end: float


class PhrasesView(View):
    """A language's phrases, checked and tried."""

    revision: int
    ambiguities: list[AmbiguityView]
    examples: dict[str, list[str]]
    """Per phrase a message with all its parts."""
    events: list[PhraseEventView]
    """What came of the gestures shown."""
    expected: list[str]
    """What may come after them."""
    may_end: bool
    """Whether a pause now would end the message, not drop it."""


@router.get("/{language_id}/phrases", responses=problem_responses(404))
@computed_briefly
def describe_phrases(
    asked: CurrentRevision,
    gesture: Shown = [],  # noqa: B006  FastAPI copies it
    then: Literal["wait", "pause"] = "wait",
) -> PhrasesView:
    """Return the ambiguities of the phrases, and the meaning of the gestures given.

    They are taken to be shown without a pause; `then` says whether a pause longer than the
    grammar's time-out follows.
    """
    row, grammar = asked.state.revision, asked.language.grammar or Grammar()
    parser = PhraseParser(grammar)
    events = [event for shown in gesture for event in _feed(parser, shown)]
    if then == "pause":
        events += parser.expire(2 * grammar.timeout)
    return PhrasesView(
        revision=row.revision,
        ambiguities=[AmbiguityView(**asdict(each)) for each in _ambiguities.get(row.document)],
        examples={each.name: list(grammar.example(each)) for each in grammar.phrases},
        events=[PhraseEventView.model_validate(event.to_dict()) for event in events],
        expected=list(parser.expected),
        may_end=parser.may_end,
    )


def _feed(parser: PhraseParser, shown: str) -> tuple[PhraseEvent, ...]:
    one, _, other = shown.partition(BETWEEN)
    if one and other:
        return parser.feed(None, 0.0, 0.0, (one, other))
    return parser.feed(one or None, 0.0, 0.0)


_ambiguities = DocumentCache(
    lambda document: find_ambiguities(Language.from_json(document).grammar or Grammar())
)
