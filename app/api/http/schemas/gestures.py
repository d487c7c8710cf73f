"""Schemas of gestures, and of what is recognised by them."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, StrictBool

from app.api.http.schemas.values import (
    Body,
    Command,
    Diver,
    ExpectedGesture,
    ExpectedGestureView,
    Identifier,
    Label,
    Landmarks,
    NewLabel,
    Seconds,
    View,
)
from app.recognition import Recognition
from app.recognition.explanation.demonstration_faults import FaultKind, Remedy
from app.recognition.explanation.explanation import Explanation
from app.recognition.gestures.gesture import MAX_TEXT_LENGTH
from app.recognition.language.file_schema import TuningEntry

SwitchPosition = Literal["auto", "on", "off"]

STROKES = "Its strokes in words; empty: a held hand shape, or only its image is known"
HELD_SHAPES = "Hand shapes that are held: 0 in a movement, 2 in a sequence of two"


class NewDemonstration(Body):
    """Where the demonstration of a gesture is."""

    clip_id: Identifier
    start: Seconds | None = None
    end: Seconds | None = None
    keep_transit: StrictBool = False
    """Keep the hand's way from and to the salute, where the range is a take's own."""
    diver: Diver = ""
    """Name of the diver who shows it; empty: unknown."""


class GestureDraft(NewDemonstration):
    """A gesture to save from a clip."""

    label: NewLabel
    salient: Landmarks | None = None
    direction: SwitchPosition = "auto"
    tempo: SwitchPosition = "auto"
    mirror: SwitchPosition = "auto"
    hand_shape: SwitchPosition = "auto"
    description: Annotated[str, Field(max_length=MAX_TEXT_LENGTH)] = ""
    command: Command = None


MOST_GESTURES_AT_ONCE = 64
"""Most gestures of one request: more than any language for divers has."""


class GesturesDraft(Body):
    """Several gestures to save from clips, in one revision."""

    gestures: Annotated[list[GestureDraft], Field(min_length=1, max_length=MOST_GESTURES_AT_ONCE)]


class DemonstrationDraft(NewDemonstration):
    """A further demonstration of a gesture."""

    label: Label
    """The gesture's."""
    salient: Landmarks | None = None
    """Null: those of the first demonstration, if one of them moves."""


class GestureChange(Body):
    """What to change about a gesture; what is left out stays."""

    label: NewLabel | None = None
    demonstration: NewDemonstration | None = None
    """Takes the place of the first demonstration, unless `further`."""
    further: StrictBool = False
    """Add the demonstration to those that the gesture has."""
    diver: Diver | None = None
    """Name of the first demonstration's diver."""
    direction: SwitchPosition | None = None
    tempo: SwitchPosition | None = None
    mirror: SwitchPosition | None = None
    hand_shape: SwitchPosition | None = None
    salient: Landmarks | None = None
    description: Annotated[str, Field(max_length=MAX_TEXT_LENGTH)] | None = None
    command: Command = None


class DemonstrationFaultView(View):
    """One fault of a demonstration, with what mends it."""

    kind: FaultKind
    sentence: str
    """The fault and the remedy, at most fifteen words."""
    words: str
    """The fault as a clause, with the numbers seen."""
    remedy: Remedy
    start: float | None
    """Seconds in the clip of a better range; null: none."""
    end: float | None


class SourceView(View):
    """Where a demonstration comes from."""

    clip_id: str
    start: float
    """Seconds in the clip."""
    end: float
    keep_transit: bool
    salutes: int = 0
    """Vulcan salutes in the demonstration, which should have none."""
    fault: str | None = None
    """The gravest of `faults` as a clause with the numbers seen; null: none."""
    faults: list[DemonstrationFaultView]
    """Why it is a bad demonstration, the gravest fault first."""


class DemonstrationView(View):
    """A demonstration of a gesture."""

    index: int
    """Its place among the gesture's demonstrations, from 0."""
    diver: str
    """Name of the diver who shows it; empty: unknown."""
    salient: list[str]
    held_shapes: int = Field(description=HELD_SHAPES)
    seconds: float | None
    """How long it lasts; null: only its image is known."""
    strokes: str = Field(description=STROKES)
    thumbnail: str
    """Path of its trajectory image, a PNG."""
    source: SourceView | None = None
    """Its clip; null: not known, or deleted."""


class GestureView(View):
    """A gesture of a language."""

    label: str
    description: str
    command: str | dict[str, Any] | None
    salient: list[str]
    held_shapes: int = Field(description=HELD_SHAPES)
    direction: SwitchPosition
    tempo: SwitchPosition
    mirror: SwitchPosition
    hand_shape: SwitchPosition
    thumbnail: str
    """Path of its trajectory image, a PNG."""
    has_trajectory: bool
    """False when imported from a file that has none."""
    source: SourceView | None = None
    """The clip of its demonstration; null: not known, or deleted."""
    demonstrations: list[DemonstrationView]
    """All of them; what is said of the gesture itself is the first one's."""


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
