"""Route of a language's phrases: ambiguities, examples, and the meaning of gestures in a row."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query
from pydantic import Field

from app.api.http.problems import problem_responses
from app.api.http.schemas.values import View
from app.api.routes.asked_revisions import CurrentRevision
from app.api.services.running_studio import DocumentCache, computed_briefly
from app.recognition import Language
from app.recognition.decision.result import Pair
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH
from app.recognition.health.ambiguity import Ambiguity, AmbiguityKind, find_ambiguities
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.parser import PhraseEvent, PhraseEventKind, PhraseParser

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

router = APIRouter(prefix="/languages", tags=["languages"])


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


def _find_ambiguities(document: str) -> tuple[Ambiguity, ...]:
    grammar = Language.from_json(document).grammar
    return () if grammar is None else find_ambiguities(grammar)


_ambiguities = DocumentCache(_find_ambiguities)
