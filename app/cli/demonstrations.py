"""Commands ``define``, ``demonstrations`` and ``trigger``: parts of a language from clips."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer

from app.bags import bag_and_topic
from app.cli.clip_argument import (
    ClipReading,
    DiverOption,
    OutputOption,
    TriggerOption,
    clip_and_span,
    read_clip,
    reads_clips,
)
from app.cli.terminal import tell
from app.recognition import Gesture, GestureError, Language, Recording, Take
from app.recognition.errors import OsgError, TriggerError
from app.recognition.explanation.demonstration_faults import find_demonstration_faults
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS
from app.recognition.language.language import require_distinct_labels
from app.recognition.poses.frame import HandShape
from app.recognition.text.look_alikes import compose
from app.recognition.triggers.trigger import NO_TRIGGER, SALUTE, ArmPose, Trigger

demonstrations_command = typer.Typer(
    help="Demonstrations of a gesture: list, add, remove.", no_args_is_help=True
)

LanguageArgument = Annotated[Path, typer.Argument(metavar="FILE", help="Language file.")]


@reads_clips
def define(
    demonstrations: Annotated[
        list[str],
        typer.Argument(
            metavar="LABEL=CLIP[,CLIP...]...",
            help="A clip per gesture with a salute, or the trigger of --trigger, at both ends; "
            "LABEL=CLIP@START-END without. "
            "Also a bag, as LABEL=BAG or LABEL=BAG@/TOPIC, or a keypoint file. Up to "
            f"{MAX_DEMONSTRATIONS} clips per gesture, best of several divers.",
        ),
    ],
    name: Annotated[str, typer.Option(help="Name of the language.")],
    output: Annotated[Path, typer.Option(help="Language file to write.")],
    author: Annotated[str, typer.Option(help="Author of the language.")] = "",
    trigger_of: TriggerOption = None,
    diver: DiverOption = "",
    *,
    reading: ClipReading,
) -> None:
    """Create a language from one demonstration clip per gesture, or several.

    With --trigger it has the trigger of that language file.
    """
    held = SALUTE if trigger_of is None else Language.load(trigger_of).trigger
    reading = replace(reading, trigger=held)
    given = [parse_demonstrations(text) for text in demonstrations]
    labels = [shown[0].label for shown in given]
    for count, _ in enumerate(labels, 1):  # before any clip is read
        require_distinct_labels(labels[:count])
    gestures = [define_gesture(shown, reading, diver=diver) for shown in given]
    language = Language(compose(name), gestures, author=author, trigger=held)
    language.save(output)
    tell(f"{output}: {len(gestures)} gestures, {output.stat().st_size / 1000:.0f} kB")


@demonstrations_command.command("list")
def list_demonstrations(language: LanguageArgument) -> None:
    """List every demonstration: label, number, diver, salient keypoints, seconds."""
    for gesture in Language.load(language).gestures:
        for number, shown in enumerate(gesture.single_demonstrations(), start=1):
            seconds = "" if shown.trajectory is None else f"{shown.trajectory.time[-1]:.2f}"
            held = () if shown.trajectory is None else shown.trajectory.hands
            followed = ",".join(shown.salient or (f"{hand.side}_hand" for hand in held))
            columns = (gesture.label, str(number), shown.diver, followed, seconds)
            typer.echo("\t".join(columns))


@demonstrations_command.command("add")
@reads_clips
def add_demonstrations(
    language: LanguageArgument,
    demonstrations: Annotated[
        list[str],
        typer.Argument(
            metavar="LABEL=CLIP[,CLIP...]...", help="Gesture of the language, and its new clips."
        ),
    ],
    diver: DiverOption = "",
    output: OutputOption = None,
    *,
    reading: ClipReading,
) -> None:
    """Add demonstrations to gestures, up to eight each; those of another diver help most."""
    loaded = Language.load(language)
    given = [parse_demonstrations(text) for text in demonstrations]
    for shown in given:
        loaded.gesture(shown[0].label)  # an unknown label is an error before any clip is read
    reading = replace(reading, trigger=loaded.trigger)
    for shown in given:
        gesture = loaded.gesture(shown[0].label)
        changed = define_gesture(shown, reading, diver=diver, gesture=gesture)
        loaded = loaded.with_changed(changed)
    _save(loaded, output or language)


@demonstrations_command.command("remove")
def remove_demonstration(
    language: LanguageArgument,
    label: Annotated[str, typer.Argument(metavar="LABEL", help="Gesture of the language.")],
    number: Annotated[
        int, typer.Argument(metavar="NUMBER", help="Demonstration, as listed: from 1.")
    ],
    output: OutputOption = None,
) -> None:
    """Remove a demonstration of a gesture that has others."""
    loaded = Language.load(language)
    gesture = loaded.gesture(label)
    _save(loaded.with_changed(_without(gesture, number)), output or language)


def _without(gesture: Gesture, number: int) -> Gesture:
    count = len(gesture.single_demonstrations())
    if not 1 <= number <= count:
        raise GestureError(
            f"{gesture.label!r} has no demonstration {number}: it has {count}, counted from 1"
        )
    return gesture.without_demonstration(number - 1)


def _save(language: Language, output: Path) -> None:
    language.save(output)
    tell(f"{output}: revision {language.revision}, {output.stat().st_size / 1000:.0f} kB")


@dataclass(frozen=True)
class DemonstrationArgument:
    """One clip of ``LABEL=CLIP`` or ``LABEL=CLIP@START-END`` on the command line.

    Attributes
    ----------
    label
        The gesture's label.
    clip
        The clip's file.
    span
        First and last second of the stroke when the user gives them, else None.

    """

    label: str
    clip: Path
    span: tuple[float, float] | None = None


def parse_demonstrations(text: str) -> list[DemonstrationArgument]:
    """Parse ``LABEL=CLIP[,CLIP...]``; an existing file whose name has commas is taken as it is.

    Raises
    ------
    GestureError
        When it is not of that form.

    """
    label, equals, rest = (part.strip() for part in text.partition("="))
    whole = bag_and_topic(str(clip_and_span(rest)[0]))[0].exists()
    clips = [rest] if whole else [clip.strip() for clip in rest.split(",")]
    if not equals or not label or not all(clips):
        raise GestureError(
            f"{text!r} is not LABEL=CLIP[,CLIP...]: name the gesture and its clips, as in "
            "circle=dive.mp4 or circle=ana.mp4,ben.mp4"
        )
    return [DemonstrationArgument(label, *clip_and_span(clip)) for clip in clips]


def define_gesture(
    demonstrations: Sequence[DemonstrationArgument],
    reading: ClipReading,
    *,
    diver: str = "",
    gesture: Gesture | None = None,
) -> Gesture:
    """Create a gesture from clips, or add them to a `gesture`, and print what each one shows.

    Raises
    ------
    GestureError
        When a clip does not hold exactly one closed take, or there are too many.

    """
    for shown in demonstrations:
        take, recording = demonstration_take(shown, reading)
        poses, trigger = take.poses, reading.trigger
        where = (take.stroke_start, take.stroke_end)
        faults = find_demonstration_faults(recording, *where, trigger=trigger)
        if gesture is None:
            gesture = Gesture.from_demonstration(shown.label, poses, diver=diver)
        else:
            gesture = gesture.with_demonstration(poses, diver)
        shown_last = gesture.single_demonstrations()[-1]
        tell(
            f"{gesture.label}: {len(poses)} poses over {poses.duration:.2f} s, "
            f"{describe_shown(shown_last)}"
        )
        for fault in faults:
            tell(f"{fault.describe(gesture.label)} It {fault.words}.")
    assert gesture is not None  # an argument names one clip at least
    return gesture


def describe_shown(gesture: Gesture) -> str:
    """Return the landmarks and hand shapes of a gesture with one demonstration, in words."""
    followed = f"salient: {', '.join(gesture.salient)}"
    if gesture.trajectory is None:
        return followed
    if gesture.is_held:
        several = len(gesture.held_shapes) > 1
        shown = f"held hand shape{'s' * several}: {_name_sides(gesture.trajectory.hands)} hand"
        return f"{shown}, two in sequence" if several else shown
    if not gesture.trajectory.moving_hands:
        return followed
    return f"{followed}; hand shape seen: {_name_sides(gesture.trajectory.moving_hands)} hand"


def _name_sides(hands: Sequence[HandShape]) -> str:
    return " and ".join(hand.side for hand in hands)


def demonstration_take(
    demonstration: DemonstrationArgument, reading: ClipReading
) -> tuple[Take, Recording]:
    """Return the only closed take of a clip, or the range given by hand, and the recording.

    Raises
    ------
    GestureError
        When the clip does not hold exactly one closed take and no range is given.

    """
    clip = demonstration.clip
    read = read_clip(clip, reading)
    takes = read.takes(demonstration.span)
    closed = [take for take in takes if take.closed]
    if len(closed) != 1:
        found = f"{len(closed)} closed and {len(takes) - len(closed)} unclosed takes"
        raise GestureError(
            f"{clip} holds {found}, a demonstration needs one closed take {reading.trigger.words}; "
            f"record it again, or give the range by hand: {demonstration.label}={clip}@START-END"
        )
    return closed[0], read.recording


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
