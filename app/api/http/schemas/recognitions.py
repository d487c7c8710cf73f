"""Schemas of recognitions and explanations."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from app.api.http.schemas.gestures import GestureChange
from app.api.http.schemas.values import Body, Identifier, Label, Pair, Seconds
from app.recognition.decision.result import RecognitionEntry
from app.recognition.language.file_schema import TuningEntry


class GestureTrial(Body):
    """A changed gesture to recognise with, on a copy of the language."""

    label: Label
    change: GestureChange


class RecognitionRequest(Body):
    """What to recognise."""

    clip_id: Identifier
    language_id: Identifier
    start: Seconds | None = None
    end: Seconds | None = None
    profile: Annotated[str, Field(max_length=32)] | None = Field(
        default=None, description="Null: the language's own"
    )
    tuning: TuningEntry | None = Field(default=None, description="Null: as the language says")
    expected: Label | None = None
    trial: GestureTrial | None = Field(
        default=None, description="Recognise with this change; the language is not edited"
    )


class RecognitionView(RecognitionEntry):
    """The full answer of a recognition, kept as a record."""

    id: str
    clip_id: str
    language_id: str
    revision: int
    start: float
    end: float
    tuning: TuningEntry | None = Field(default=None, description="Null: as the language says")
    trial: GestureTrial | None = Field(
        default=None, description="The change it was recognised with; null: none"
    )
    expected: str | None
    created: datetime


class ExplanationView(BaseModel):
    """Why a recognition came out as it did."""

    model_config = ConfigDict(extra="allow")

    id: str = Field(description="The recognition's")
    profile: str
    expected: str
    label: str | None
    pair: Pair
    nearest: str
    right: bool
    confidence: float
    other: str | None = Field(description="The gesture that the expected one is held against")
    margin: float | None = Field(description="Score of the other minus that of the expected")
    runner_up: str | None = Field(
        default=None, description="The nearest gesture but `nearest`; null: none is comparable"
    )
    sentence: str = Field(description="Why and what the diver can do, in at most fifteen words")
    details: list[str] = Field(description="The numbers behind the sentence")
    score: float | None = Field(description="Of the expected gesture; null: not comparable")
    other_score: float | None = Field(description="Of the other gesture; null: not comparable")
    novelty: float | None = Field(
        description="Of the expected gesture: above 1 it is rejected; null: not measured"
    )
    fault: str | None = Field(description="Why the keypoints are too poor; null: they are not")
    turned: float | None = Field(
        description="Share of the scores' difference that penalties for other views bring"
    )
    facing: float | None = Field(
        description="Degrees the diver is turned by, positive to the own left; null: not known"
    )
    votes: dict[str, int]
    support: dict[str, float] = Field(description="By label the weight of its voters")
    breakdown: list[dict[str, Any]] = Field(description="Per voter, the most against it first")
    verdicts: list[dict[str, Any]] = Field(description="`breakdown`, as version 0.2 called it")
    alignments: list[dict[str, Any]]
    causes: list[dict[str, Any]] = Field(
        description="Why, the cause first, each with its evidence; empty: none is known"
    )
    blame: list[dict[str, Any]] = Field(
        description="Demonstrations of the gesture meant that are at fault for the known takes"
    )
    counterfactuals: list[dict[str, Any]] = Field(
        description="Verified; by none does a gesture lose a demonstration. What repairs most "
        "known takes comes first, the take as another demonstration last"
    )
    tried: int
    notes: list[str] = Field(
        default_factory=list,
        description="What is wrong with the demonstrations or the range, in sentences",
    )
