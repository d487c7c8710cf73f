"""Command ``osg-studio trigger``: shows and sets what begins and ends a take of a language."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from app.cli.clip_argument import (
    ClipReading,
    OutputOption,
    clip_and_span,
    read_clip,
    reads_clips,
)
from app.cli.terminal import tell
from app.recognition import Language
from app.recognition.errors import OsgError, TriggerError
from app.recognition.triggers.trigger import NO_TRIGGER, SALUTE, ArmPose, Trigger


@reads_clips
def trigger(
    language: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="Language file; a new one is made when missing."),
    ],
    pose: Annotated[
        str | None,
        typer.Option(
            metavar="CLIP",
            help="Clip, or CLIP@START-END, in which the arms are held still: this pose begins and "
            "ends a take.",
        ),
    ] = None,
    stop: Annotated[
        str | None, typer.Option(metavar="CLIP", help="With --pose: another pose ends it.")
    ] = None,
    gesture: Annotated[
        str | None,
        typer.Option(metavar="LABEL", help="A gesture of the language begins and ends a take."),
    ] = None,
    stop_gesture: Annotated[
        str | None, typer.Option(metavar="LABEL", help="With --gesture: another one ends it.")
    ] = None,
    salute: Annotated[bool, typer.Option("--salute", help="A Vulcan salute again.")] = False,
    none: Annotated[
        bool, typer.Option("--none", help="No trigger: gestures are found anywhere.")
    ] = False,
    output: OutputOption = None,
    *,
    reading: ClipReading,
) -> None:
    """Show what begins and ends a take of a language, or set it: salute, pose, gesture, nothing."""
    given = sum((pose is not None, gesture is not None, salute, none))
    lacking = (stop and not pose) or (stop_gesture and not gesture)
    if given > 1 or lacking:
        raise OsgError(
            "give one of --pose CLIP, --gesture LABEL, --salute and --none; --stop CLIP needs "
            "--pose, and --stop-gesture LABEL needs --gesture"
        )
    if not given:
        typer.echo(Language.load(language).trigger.words)
        return
    loaded = Language.load(language) if language.exists() else Language(name=language.stem)
    chosen = SALUTE if salute else NO_TRIGGER
    if pose is not None:
        ends = None if stop is None else read_pose(stop, reading)
        chosen = Trigger("pose", read_pose(pose, reading), ends)
    if gesture is not None:
        chosen = Trigger("gesture", start_label=gesture, stop_label=stop_gesture or "")
    changed = replace(loaded, trigger=chosen, revision=loaded.revision + language.exists())
    target = output or language
    changed.save(target)
    tell(f"{target}: {chosen.words}")


def read_pose(text: str, reading: ClipReading) -> ArmPose:
    """Read the pose that is held in ``CLIP`` or ``CLIP@START-END``.

    Raises
    ------
    TriggerError
        When no pose is held there, with the clip's name.

    """
    clip, span = clip_and_span(text)
    poses = read_clip(clip, reading).recording.poses
    try:
        return ArmPose.from_poses(poses if span is None else poses.between(*span))
    except TriggerError as error:
        raise TriggerError(f"{text}: {error}") from error
