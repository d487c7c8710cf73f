"""Trigger entry: conversion of triggers to and from their entry in the language file."""

from __future__ import annotations

from app.recognition.errors import LanguageError, TriggerError
from app.recognition.language.trigger_schema import ArmPoseEntry, TriggerEntry
from app.recognition.triggers.arm_pose import ArmPose
from app.recognition.triggers.trigger import SALUTE, Trigger


def trigger_to_entry(trigger: Trigger) -> TriggerEntry | None:
    """Return the file's entry of a trigger; None for the salute."""
    if trigger == SALUTE:
        return None
    start, stop = (_pose_to_entry(pose) for pose in (trigger.start, trigger.stop))
    stop_label = "" if trigger.stop_label == trigger.start_label else trigger.stop_label
    return TriggerEntry(
        kind=trigger.kind,
        start=start,
        stop=stop,
        start_label=trigger.start_label,
        stop_label=stop_label,
    )


def entry_to_trigger(entry: TriggerEntry | None) -> Trigger:
    """Return the trigger of a file's entry, or the salute without one.

    Raises
    ------
    LanguageError
        When poses are missing, superfluous, unusable or too much alike.

    """
    if entry is None:
        return SALUTE
    try:
        start, stop = (_entry_to_pose(pose) for pose in (entry.start, entry.stop))
        return Trigger(entry.kind, start, stop, entry.start_label, entry.stop_label)
    except TriggerError as error:
        raise LanguageError(str(error), "/trigger") from error


def _pose_to_entry(pose: ArmPose | None) -> ArmPoseEntry | None:
    if pose is None:
        return None
    return ArmPoseEntry(**{name: list(place) for name, place in pose.joints.items()})


def _entry_to_pose(entry: ArmPoseEntry | None) -> ArmPose | None:
    return None if entry is None else ArmPose.of_joints(entry.model_dump())
