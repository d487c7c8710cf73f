"""Application `osg-studio`: defines the commands and turns errors into exit codes.

Text for people goes to stderr, data to stdout. Exit codes: 0 done, 1 nothing was recognised or the
check found an error, 2 bad use or bad input, with one line that names cause and next step, 3 the
program failed, with a traceback, 4 a robot went on without a log that it could not write.
"""

from __future__ import annotations

import json
import sys
import traceback
from collections.abc import Sequence
from functools import cache
from itertools import zip_longest
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from pydantic import ValidationError
from typer.main import get_command

from app import __version__
from app.cli.administration.audit import audit
from app.cli.administration.backup import backup, restore
from app.cli.administration.tokens import tokens_command
from app.cli.batches.folder import is_folder_of_clips
from app.cli.batches.run import FolderBatch
from app.cli.check import check
from app.cli.clip_argument import (
    ClipReading,
    DiverOption,
    FrameRateOption,
    FrameSizeOption,
    LandmarkOption,
    TriggerOption,
    clip_and_span,
    define_gesture,
    keypoint_options,
    parse_demonstrations,
    recognize_clip,
)
from app.cli.demonstrations import demonstrations_command
from app.cli.estimator_options import EstimatorOption, HandsOption, WaterOption
from app.cli.evaluate import evaluate
from app.cli.extract import extract
from app.cli.language_code import code
from app.cli.mcap_file import name_recognitions, save_bag
from app.cli.phrase import phrase
from app.cli.recognition_report import build_report
from app.cli.robots.robot import robot
from app.cli.robots.ros_arguments import split_ros_arguments
from app.cli.samples import samples
from app.cli.slate import slate
from app.cli.terminal import (
    describe_error,
    people,
    progress_bar,
    show_explanation,
    show_recognition,
)
from app.cli.trigger import trigger
from app.recognition import Language, Recognition, Recognizer, Recording, Take
from app.recognition.errors import OsgError
from app.recognition.estimation.factory import MEDIAPIPE_HANDS
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.explanation import explain
from app.recognition.gestures.profile import PROFILES
from app.recognition.language.export_format import FileFormat
from app.recognition.language.language import require_distinct_labels
from app.recognition.language.osg_reference import from_reference, is_reference
from app.recognition.spotting import Spotter
from app.recognition.text.look_alikes import compose
from app.recognition.triggers.arm_pose import HOLD_SECONDS
from app.recognition.triggers.trigger import SALUTE
from app.system.confinement import hide_memory

NOTHING_RECOGNISED = 1
BAD_INPUT = 2
CRASHED = 3

_build_command = cache(get_command)
"""Cached, because the tests run it a thousand times."""

command_line = typer.Typer(
    name="osg-studio",
    help="Design gesture languages for underwater robots: one demonstration per gesture.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
models_command = typer.Typer(
    help="Pose and hand models: install, list, export.", invoke_without_command=True
)
command_line.add_typer(models_command, name="models")
command_line.add_typer(demonstrations_command, name="demonstrations")
command_line.command()(trigger)
command_line.command()(evaluate)
command_line.command()(extract)
command_line.command()(check)
command_line.command()(code)
command_line.command()(slate)
command_line.command()(robot)
command_line.command()(phrase)
command_line.command()(backup)
command_line.command()(restore)
command_line.add_typer(tokens_command, name="tokens")
command_line.command()(audit)
command_line.command()(samples)


@command_line.callback(invoke_without_command=True)
def top(
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    """Handle options before any command."""
    if version:
        typer.echo(__version__)
        raise typer.Exit


@command_line.command()
def serve(
    host: Annotated[
        str, typer.Option(envvar="OSG_HOST", help="Address to listen on.")
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(envvar="OSG_PORT", help="Port to listen on; 0 picks a free one.")
    ] = 8000,
    data_dir: Annotated[
        Path | None, typer.Option(help="Folder for clips, languages and the database.")
    ] = None,
    token: Annotated[
        str | None,
        typer.Option(
            envvar="OSG_TOKEN", help="Secret that every visitor needs; required off loopback."
        ),
    ] = None,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Do not open a browser.")
    ] = False,
) -> None:
    """Start the studio and open it in the browser."""
    try:
        from app.server import run
        from app.settings import Settings
    except ModuleNotFoundError as error:
        raise OsgError(
            f"the studio's packages are not installed ({error.name} is missing); "
            'install them, on Python 3.11 or newer, with: pip install "osg-studio[studio]"'
        ) from error
    given: dict[str, Any] = {"host": host, "port": port, "data_dir": data_dir, "token": token}
    try:
        settings = Settings(**{name: value for name, value in given.items() if value is not None})
    except ValidationError as error:
        raise OsgError(error.errors()[0]["msg"].removeprefix("Value error, ")) from error
    # A reader of received files must not find the token in this process's memory.
    hide_memory()
    run(settings, open_browser=not no_browser)


@command_line.command()
def define(
    demonstrations: Annotated[
        list[str],
        typer.Argument(
            metavar="LABEL=CLIP[,CLIP...]...",
            help="A clip per gesture with a salute, or the trigger of --trigger, at both ends; "
            "LABEL=CLIP@START-END without. "
            "Also a bag, as LABEL=BAG or LABEL=BAG@/TOPIC, or a keypoint file. Up to five clips "
            "per gesture, best of several divers.",
        ),
    ],
    name: Annotated[str, typer.Option(help="Name of the language.")],
    output: Annotated[Path, typer.Option(help="Language file to write.")],
    author: Annotated[str, typer.Option(help="Author of the language.")] = "",
    trigger_of: TriggerOption = None,
    diver: DiverOption = "",
    water: WaterOption = "auto",
    estimator: EstimatorOption = "onnx",
    hands: HandsOption = MEDIAPIPE_HANDS,
    frame_rate: FrameRateOption = None,
    frame_size: FrameSizeOption = None,
    landmark: LandmarkOption = None,
) -> None:
    """Create a language from one demonstration clip per gesture, or several.

    With --trigger it has the trigger of that language file.
    """
    keypoints = keypoint_options(frame_rate, frame_size, landmark)
    held = SALUTE if trigger_of is None else Language.load(trigger_of).trigger
    reading = ClipReading(water, estimator, hands, keypoints=keypoints, trigger=held)
    given = [parse_demonstrations(text) for text in demonstrations]
    labels = [shown[0].label for shown in given]
    for count, _ in enumerate(labels, 1):  # before any clip is read
        require_distinct_labels(labels[:count])
    gestures = [define_gesture(shown, reading, diver=diver) for shown in given]
    language = Language(compose(name), gestures, author=author, trigger=held)
    language.save(output)
    people.print(f"{output}: {len(gestures)} gestures, {output.stat().st_size / 1000:.0f} kB")


@command_line.command()
def recognize(
    clip: Annotated[
        str,
        typer.Argument(
            help="Clip or rosbag2 with gestures between salutes, or CLIP@START-END. Or a keypoint "
            "file: OpenPose's folder, MediaPipe's CSV or JSON, DeepLabCut's CSV, SLEAP's .slp, "
            ".h5. Or a folder of clips, for one table; run it again to go on after an interruption."
        ),
    ],
    language: Annotated[Path, typer.Option(help="Language file.")],
    profile: Annotated[
        str | None,
        typer.Option(help=f"Set of voters, {' or '.join(PROFILES)}; by default the language's."),
    ] = None,
    expected: Annotated[
        str | None,
        typer.Option(metavar="LABEL", help="Gesture that was meant; prints an explanation."),
    ] = None,
    without_salutes: Annotated[
        bool, typer.Option("--without-salutes", help="Find gestures anywhere in the clip.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    topic: Annotated[
        str | None,
        typer.Option(help="Topic of a bag that has several."),
    ] = None,
    mcap: Annotated[
        Path | None,
        typer.Option(help="Write clip and recognitions to this MCAP file, for Foxglove."),
    ] = None,
    table: Annotated[
        Path, typer.Option(help="Table of a folder's takes to write, .csv or .parquet.")
    ] = Path("recognitions.csv"),
    water: WaterOption = "auto",
    estimator: EstimatorOption = "onnx",
    hands: HandsOption = MEDIAPIPE_HANDS,
    frame_rate: FrameRateOption = None,
    frame_size: FrameSizeOption = None,
    landmark: LandmarkOption = None,
) -> None:
    """Recognise the gestures in a clip, with every voter's distance to every gesture."""
    path, span = clip_and_span(clip)
    loaded = Language.load(language)
    if expected is not None:
        loaded.gesture(expected)  # raises an error for an unknown label before the clip is read
    recognizer = Recognizer(loaded, profile)
    spots = without_salutes or loaded.trigger.spots
    spotter = Spotter(recognizer, triggered=not without_salutes) if spots else None
    keypoints = keypoint_options(frame_rate, frame_size, landmark)
    reading = ClipReading(water, estimator, hands, topic, keypoints)
    if is_folder_of_clips(path):
        if as_json or mcap is not None or expected is not None:
            raise OsgError(
                f"{path} is a folder of clips: --json, --mcap and --expected are for one clip; "
                "give --table for the folder's results"
            )
        batch = FolderBatch(path, table, recognizer, reading, spotter, excluded=(language,))
        recognised = batch.run()
    else:
        recording, results = recognize_clip(path, span, reading, recognizer, spotter)
        if mcap is not None:
            named = name_recognitions(loaded, expected, results)
            save_bag(mcap, path, topic, recording, named, loaded.trigger)
        show_results(path, recognizer, results, expected, as_json=as_json)
        if not results:
            explain_absence(path, recording, recognizer, without_salutes=spots)
        recognised = sum(result.label is not None for _, result in results)
    if not recognised:
        raise typer.Exit(NOTHING_RECOGNISED)


def show_results(
    path: Path,
    recognizer: Recognizer,
    results: Sequence[tuple[Take, Recognition]],
    expected: str | None,
    *,
    as_json: bool,
) -> None:
    """Print the recognitions of one clip, with explanations where a gesture was expected."""
    takes = [take for take, _ in results]
    explanations = [
        explain(RecognitionContext.of_take(recognizer, take), expected)
        for take in takes
        if expected is not None
    ]
    if as_json:
        name = recognizer.language.name
        report = build_report(str(path), name, recognizer.profile, results, explanations)
        typer.echo(json.dumps(report, allow_nan=False))
        return
    for (take, result), explanation in zip_longest(results, explanations):
        show_recognition(take, result, recognizer.language.trigger)
        if explanation is not None:
            show_explanation(explanation)


def explain_absence(
    path: Path, recording: Recording, recognizer: Recognizer, *, without_salutes: bool
) -> None:
    """Print why a clip has no take, and what to do."""
    seconds = f"{recording.poses.duration:.1f} s"
    if without_salutes:
        people.print(
            f"{path}: no gesture of {recognizer.language.name!r} found in {seconds}; "
            f"pause before and after a gesture, or give the range: {path}@START-END"
        )
    else:
        people.print(
            f"{path}: no salute found in {seconds}, so no take; hold the "
            f"salute for at least 0.3 s, or give the range: {path}@START-END"
            if recognizer.language.trigger == SALUTE
            else f"{path}: no take {recognizer.language.trigger.words} found in {seconds}; hold "
            f"the pose for at least {HOLD_SECONDS:g} s, or give the range: {path}@START-END"
        )


@command_line.command()
def convert(
    source: Annotated[
        Path, typer.Argument(metavar="IN", help="Language file of osg-studio or osg-reference.")
    ],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="File to write.")],
    file_format: Annotated[
        FileFormat | None,
        typer.Option(
            "--format",
            help="Format to write: proteus for OUT.ldf, otherwise osg-studio if left out.",
        ),
    ] = None,
) -> None:
    """Convert a language file: osg-studio, osg-reference (published implementation), proteus."""
    language = read_language(source)
    if file_format is None:
        proteus = target.suffix == FileFormat.PROTEUS.suffix
        file_format = FileFormat.PROTEUS if proteus else FileFormat.OSG_STUDIO
    if any(gesture.trajectory is None for gesture in language.gestures):
        people.print(f"{source}: no trajectories, only images: osg-reference files have none")
    several = [gesture.label for gesture in language.gestures if gesture.further]
    if several and file_format is FileFormat.OSG_REFERENCE:
        people.print(
            f"{target}: {file_format.value} keeps only the first demonstration of "
            f"{', '.join(several)}",
            markup=False,
        )
    if language.trigger != SALUTE and file_format is not FileFormat.OSG_STUDIO:
        people.print(f"{target}: {file_format.value} knows no trigger; tell it on the slate")
    if file_format is FileFormat.OSG_STUDIO:
        language.save(target)
    else:
        target.write_text(file_format.write(language), encoding="utf-8")
    people.print(f"{target}: {len(language.gestures)} gestures as {file_format.value}")


@models_command.callback()
def models(context: typer.Context) -> None:
    """List the models when no subcommand follows."""
    if context.invoked_subcommand is None:
        list_models()


@models_command.command("list")
def list_models() -> None:
    """List the models with state, size and path."""
    from app.recognition.models import installed_models

    for model in installed_models():
        typer.echo(f"{model.name}\t{model.state}\t{model.size}\t{model.path}")


@models_command.command("install")
def install_models_command(
    source: Annotated[
        Path | None, typer.Option(help="Folder to copy from: exported, or that of a release.")
    ] = None,
) -> None:
    """Copy model files that are missing or damaged to the models folder; a wheel has them."""
    from app.recognition.models import install_models, models_dir

    with progress_bar("models") as advance:
        install_models(
            progress=lambda stage, done, total: advance(done, total, stage), source=source
        )
    people.print(f"all models are in {models_dir()}")


@models_command.command("export")
def export_models_command(
    directory: Annotated[Path, typer.Argument(help="Folder to copy the models to.")],
) -> None:
    """Copy the models to a folder, for a robot without network."""
    from app.recognition.models import export_models

    export_models(directory)
    people.print(f"on the robot: osg-studio models install --source {directory}")


def read_language(source: Path) -> Language:
    """Read a language file of OSG Studio or of the published implementation.

    Raises
    ------
    LanguageError
        When the file is neither; contains the JSON pointer to the fault.

    """
    content = source.read_bytes()
    if is_reference(content):
        return from_reference(content, source.stem)
    return Language.from_json(content)


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run the command line and exit with its code; known errors print one line on stderr."""
    try:
        given = sys.argv[1:] if arguments is None else arguments
        # The other commands refuse ROS arguments like any unknown option.
        own, ros = split_ros_arguments(given) if given[:1] == ["robot"] else (given, [])
        _build_command(command_line)(args=own, prog_name="osg-studio", obj=ros)
    except (OsgError, OSError) as error:
        sys.stderr.write(f"osg-studio: {describe_error(error)}\n")
        sys.exit(BAD_INPUT)
    except Exception:
        # Python's own code of a crash is 1, which also means that nothing was recognised.
        traceback.print_exc()
        sys.exit(CRASHED)
    sys.exit(0)
