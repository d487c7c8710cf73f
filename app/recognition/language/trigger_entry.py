"""Trigger entry of a language file, and its schema."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, Field

from app.recognition.errors import point_to
from app.recognition.text.described import STRICT
from app.recognition.triggers.arm_pose import ArmPose
from app.recognition.triggers.trigger import SALUTE, Trigger, TriggerKind

Coordinate = Annotated[float, Field(allow_inf_nan=False, ge=-10, le=10)]

PlaceEntry = Annotated[list[Coordinate], Field(min_length=2, max_length=2)]


class _Model(BaseModel):
    model_config = STRICT


class ArmPoseEntry(_Model):
    """A pose of the arms: where elbows and wrists are held.

    Each place is x to the image's right and y down from the middle of the shoulders, in torso
    lengths.
    """

    left_elbow: PlaceEntry
    left_wrist: PlaceEntry
    right_elbow: PlaceEntry
    right_wrist: PlaceEntry


class TriggerEntry(_Model):
    """What begins and ends a take."""

    kind: TriggerKind
    """salute: a Vulcan salute. pose: a held pose of the arms. gesture: a gesture of the language.
    none: nothing, gestures are found anywhere."""
    start: ArmPoseEntry | None = None
    """Of kind pose, the pose that begins a take."""
    stop: ArmPoseEntry | None = None
    """The pose that ends it. Left out when it is the one that begins it."""
    start_label: str = ""
    """Of kind gesture, the label of the gesture that begins a take."""
    stop_label: str = ""
    """Label of the gesture that ends it. Left out when it is the same."""


def trigger_to_entry(trigger: Trigger) -> TriggerEntry | None:
    """Return the file's entry of a trigger; None for the salute."""
    if trigger == SALUTE:
        return None
    poses = (trigger.start, trigger.stop)
    start, stop = (None if pose is None else _pose_to_entry(pose) for pose in poses)
    stop_label = "" if trigger.stop_label == trigger.start_label else trigger.stop_label
    return TriggerEntry(**vars(trigger) | {"start": start, "stop": stop, "stop_label": stop_label})


def entry_to_trigger(entry: TriggerEntry | None) -> Trigger:
    """Return the trigger of a file's entry, or the salute without one.

    Raises
    ------
    LanguageError
        When poses are missing, superfluous, unusable or too much alike.

    """
    if entry is None:
        return SALUTE
    with point_to("/trigger"):
        poses = (entry.start, entry.stop)
        start, stop = (pose and ArmPose.of_joints(pose.model_dump()) for pose in poses)
        read: dict[str, Any] = vars(entry) | {"start": start, "stop": stop}
        return Trigger(**read)


def _pose_to_entry(pose: ArmPose) -> ArmPoseEntry:
    return ArmPoseEntry(**{name: list(place) for name, place in pose.joints.items()})
