"""Schemas of recognitions and explanations."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated

from pydantic import ConfigDict, Field

from app.api.http.schemas.gestures import GestureChange
from app.api.http.schemas.values import (
    Body,
    ExpectedGesture,
    ExpectedGestureView,
    Identifier,
    Label,
    Seconds,
)
from app.recognition import Recognition
from app.recognition.explanation.explanation import Explanation
from app.recognition.language.file_schema import TuningEntry


class GestureTrial(Body):
    """A changed gesture to recognise with, on a copy of the language."""

    label: Label
    change: GestureChange


class RecognitionRequest(ExpectedGesture):
    """What to recognise."""

    clip_id: Identifier
    language_id: Identifier
    start: Seconds | None = None
    end: Seconds | None = None
    profile: Annotated[str, Field(max_length=32)] | None = None
    """Null: the language's own."""
    tuning: TuningEntry | None = None
    """Null: as the language says."""
    trial: GestureTrial | None = None
    """Recognise with this change; the language is not edited."""


class RecognitionView(ExpectedGestureView, Recognition):
    """The full answer of a recognition, kept as a record."""

    model_config = ConfigDict(extra="allow")

    id: str
    clip_id: str
    language_id: str
    revision: int
    start: float
    end: float
    tuning: TuningEntry | None = None
    """Null: as the language says."""
    trial: GestureTrial | None = None
    """The change it was recognised with; null: none."""
    without: list[list[str | int]] = Field(default_factory=list)
    """Label and number of the demonstrations that the take is itself, which did not read it."""
    created: datetime


class ExplanationView(Explanation):
    """Why a recognition came out as it did."""

    id: str = Field(description="The recognition's")
    notes: list[str] = Field(
        default_factory=list,
        description="What is wrong with the demonstrations or the range, in sentences",
    )
