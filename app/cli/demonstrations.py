"""Command ``demonstrations``: list, add and remove the demonstrations of a language's gestures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.clip_argument import (
    ClipReading,
    DiverOption,
    FrameRateOption,
    FrameSizeOption,
    LandmarkOption,
    define_gesture,
    keypoint_options,
    parse_demonstrations,
)
from app.cli.estimator_options import EstimatorOption, HandsOption, WaterOption
from app.cli.terminal import people
from app.recognition import Gesture, GestureError, Language
from app.recognition.estimation.factory import MEDIAPIPE_HANDS

demonstrations_command = typer.Typer(
    help="Demonstrations of a gesture: list, add, remove.", no_args_is_help=True
)

LanguageArgument = Annotated[Path, typer.Argument(metavar="FILE", help="Language file.")]

OutputOption = Annotated[
    Path | None, typer.Option(help="Language file to write; by default the same file.")
]


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
    water: WaterOption = "auto",
    estimator: EstimatorOption = "onnx",
    hands: HandsOption = MEDIAPIPE_HANDS,
    frame_rate: FrameRateOption = None,
    frame_size: FrameSizeOption = None,
    landmark: LandmarkOption = None,
) -> None:
    """Add demonstrations to gestures, up to five each; those of another diver help most."""
    loaded = Language.load(language)
    given = [parse_demonstrations(text) for text in demonstrations]
    for shown in given:
        loaded.gesture(shown[0].label)  # an unknown label is an error before any clip is read
    keypoints = keypoint_options(frame_rate, frame_size, landmark)
    reading = ClipReading(water, estimator, hands, keypoints=keypoints, trigger=loaded.trigger)
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
    people.print(
        f"{output}: revision {language.revision}, {output.stat().st_size / 1000:.0f} kB",
        markup=False,
    )
