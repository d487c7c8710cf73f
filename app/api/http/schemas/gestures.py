"""Schemas of gestures."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field

from app.api.http.schemas.values import Body, Command, Identifier, Label, Landmarks, Seconds
from app.recognition.gestures.gesture import MAX_TEXT_LENGTH

SwitchPosition = Literal["auto", "on", "off"]


class NewDemonstration(Body):
    """Where the demonstration of a gesture is."""

    clip_id: Identifier
    start: Seconds | None = None
    end: Seconds | None = None
    keep_transit: bool = Field(
        default=False,
        description="Keep the hand's way from and to the salute, where the range is a take's own",
    )


class GestureDraft(NewDemonstration):
    """A gesture to save from a clip."""

    label: Label
    salient: Landmarks | None = None
    direction: SwitchPosition = "auto"
    tempo: SwitchPosition = "auto"
    mirror: SwitchPosition = "auto"
    description: Annotated[str, Field(max_length=MAX_TEXT_LENGTH)] = ""
    command: Command = None


class GestureChange(Body):
    """What to change about a gesture; what is left out stays."""

    label: Label | None = None
    demonstration: NewDemonstration | None = Field(
        default=None, description="Takes the place of the one that made the gesture"
    )
    direction: SwitchPosition | None = None
    tempo: SwitchPosition | None = None
    mirror: SwitchPosition | None = None
    salient: Landmarks | None = None
    description: Annotated[str, Field(max_length=MAX_TEXT_LENGTH)] | None = None
    command: Command = None


class SourceView(BaseModel):
    """Where a demonstration comes from."""

    clip_id: str
    start: float = Field(description="Seconds in the clip")
    end: float
    keep_transit: bool
    salutes: int = Field(
        default=0, description="Vulcan salutes in the demonstration, which should have none"
    )


class GestureView(BaseModel):
    """A gesture of a language."""

    label: str
    description: str
    command: str | dict[str, Any] | None
    salient: list[str]
    direction: SwitchPosition
    tempo: SwitchPosition
    mirror: SwitchPosition
    thumbnail: str = Field(description="Path of its trajectory image, a PNG")
    has_trajectory: bool = Field(description="False when imported from a file that has none")
    source: SourceView | None = Field(
        default=None, description="The clip of its demonstration; null: not known, or deleted"
    )
