"""Trigger schema: pydantic models of the language file's entry of a trigger."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from app.recognition.triggers.trigger import TriggerKind

Coordinate = Annotated[float, Field(allow_inf_nan=False, ge=-10, le=10)]

PlaceEntry = Annotated[
    list[Coordinate],
    Field(
        min_length=2,
        max_length=2,
        description="x to the image's right and y down from the middle of the shoulders, in torso "
        "lengths.",
    ),
]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class ArmPoseEntry(_Model):
    """A pose of the arms: where elbows and wrists are held."""

    left_elbow: PlaceEntry
    left_wrist: PlaceEntry
    right_elbow: PlaceEntry
    right_wrist: PlaceEntry


class TriggerEntry(_Model):
    """What begins and ends a take."""

    kind: Annotated[
        TriggerKind,
        Field(
            description="salute: a Vulcan salute. pose: a held pose of the arms. gesture: a "
            "gesture of the language. none: nothing, gestures are found anywhere."
        ),
    ]
    start: Annotated[
        ArmPoseEntry | None, Field(description="Of kind pose, the pose that begins a take.")
    ] = None
    stop: Annotated[
        ArmPoseEntry | None,
        Field(description="The pose that ends it. Left out when it is the one that begins it."),
    ] = None
    start_label: Annotated[
        str, Field(description="Of kind gesture, the label of the gesture that begins a take.")
    ] = ""
    stop_label: Annotated[
        str, Field(description="Label of the gesture that ends it. Left out when it is the same.")
    ] = ""
