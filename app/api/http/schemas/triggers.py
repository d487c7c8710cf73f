"""Schemas of triggers."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from app.api.http.schemas.values import Body, Identifier, Seconds
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH
from app.recognition.triggers.trigger import TriggerKind


class HeldPose(Body):
    """Where a pose of the arms is held."""

    clip_id: Identifier
    start: Seconds | None = Field(default=None, description="Null: of the clip")
    end: Seconds | None = Field(default=None, description="Null: of the clip")


class TriggerDraft(Body):
    """What shall begin and end the takes of a language."""

    kind: TriggerKind
    start: HeldPose | None = Field(
        default=None,
        description="Of kind pose, the one that begins a take; null: the one that does already",
    )
    stop: HeldPose | None = Field(
        default=None, description="The pose that ends a take; null: the one that begins it"
    )
    start_label: Annotated[
        str, Field(max_length=MAX_LABEL_LENGTH, description="Of kind gesture, which one begins")
    ] = ""
    stop_label: Annotated[
        str, Field(max_length=MAX_LABEL_LENGTH, description="Which one ends; empty: the same")
    ] = ""
