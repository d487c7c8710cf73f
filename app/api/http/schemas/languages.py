"""Schemas of languages and their revisions."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal

from pydantic import Field

from app.api.http.schemas.gestures import GestureView
from app.api.http.schemas.values import Author, Body, NewName, View
from app.recognition.decision.outcome import MOST_REFUSED_AT_ALL
from app.recognition.gestures.profile import ProfileName
from app.recognition.language.file_schema import TriggerEntry, TuningEntry
from app.recognition.language.grammar_entry import GrammarEntry


class LanguageDraft(Body):
    """A new language."""

    name: NewName
    author: Author = ""


class LanguageChange(Body):
    """What to change about a language; what is left out stays."""

    name: NewName | None = None
    author: Author | None = None
    grammar: GrammarEntry | None = None
    """The phrases; null: none."""
    profile: ProfileName | None = None
    """The voters that recognise it."""
    tuning: TuningEntry | None = None
    """What differs from the profile; null: nothing."""
    most_refused: float | None = Field(default=None, gt=0, le=MOST_REFUSED_AT_ALL)
    """Share of right takes that may be refused, where several people have shown the gestures."""


class LanguageRevert(Body):
    """Which revision to go back to."""

    revision: Annotated[int, Field(ge=0, le=2**31 - 1)]


class LanguageSummary(View):
    """A language in a list."""

    id: str
    name: str
    author: str
    revision: int
    change: str
    """What the newest revision did."""
    labels: list[str]
    sample: bool
    """Whether it came with the program."""
    created: datetime
    updated: datetime


class LanguageView(LanguageSummary):
    """A language with its gestures."""

    gestures: list[GestureView]
    sha256: str
    """Checksum of the language file, which the robot reports."""
    code: str
    """Short code of `sha256`, to compare with the robot's."""
    grammar: GrammarEntry | None
    """Null: every gesture is a message of its own."""
    profile: ProfileName
    """The voters that recognise it."""
    tuning: TuningEntry | None
    """What differs from the profile; null: nothing."""
    tuning_words: str
    """The same for people: recognised ..."""
    most_refused: float
    """Share of right takes that may be refused; the limit follows from it where several people have
    shown the gestures."""
    trigger: TriggerEntry | None
    """What begins and ends a take; null: a salute."""
    trigger_words: str
    """The same for people: takes lie ..."""


class RevisionView(View):
    """One revision in a language's history."""

    revision: int
    name: str
    author: str
    labels: list[str]
    change: str
    created: datetime


class GestureComparison(View):
    """A gesture in two revisions of its language."""

    kind: Literal["added", "removed", "changed", "same"]
    before: GestureView | None
    """Null: the older revision does not have it."""
    after: GestureView | None
    """Null: the newer revision does not have it."""
    words: list[str]
    """What changed about it, a sentence each."""


class RevisionComparison(View):
    """Two revisions of a language, side by side."""

    older: RevisionView | None
    """Null: compared with nothing."""
    newer: RevisionView
    words: list[str]
    """What changed about the language itself."""
    gestures: list[GestureComparison]
    """In the newer revision's order, then those it does not have any more."""
