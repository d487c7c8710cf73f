"""Command ``recognize``: the gestures in a clip or folder, as words, JSON, table or MCAP file."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import BaseModel, ConfigDict, Field
from rich.filesize import decimal

from app.bags import bag_and_topic
from app.bags.export_writer import NamedRecognition, write_bag
from app.cli.batch import FolderBatch, is_folder_of_clips
from app.cli.clip_argument import ClipReading, clip_and_span, reads_clips, recognize_clip
from app.cli.terminal import progress_bar, show_explanation, show_recognition, tell
from app.clip_sources import source_of
from app.evaluation.confusion import NONE
from app.recognition import Language, Recognition, Recognizer, Recording, Take
from app.recognition.errors import OsgError
from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.explanation import explain
from app.recognition.gestures.profile import PROFILES, ProfileName
from app.recognition.recording.chapters import tell_chapters
from app.recognition.recording.extraction import explain_missing_salutes
from app.recognition.recording.recording import tell_clock
from app.recognition.spotting import Spotter
from app.recognition.text.described import DESCRIBED
from app.recognition.text.wording import ask_twins
from app.recognition.triggers.trigger import POSE_SECONDS, SALUTE

Seconds = Annotated[float, Field(ge=0, description="Seconds after the clip's first frame.")]


NOTHING_RECOGNISED = 1
"""Exit code when no gesture was recognised."""


@reads_clips
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
        typer.Option(
            metavar="LABEL",
            help=f"Gesture that was meant; prints an explanation. {NONE}: none of these.",
        ),
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
    *,
    reading: ClipReading,
) -> None:
    """Recognise the gestures in a clip, with every voter's distance to every gesture."""
    path, span = clip_and_span(clip)
    loaded = Language.load(language)
    if expected is not None and expected != NONE:
        # Raises an error for an unknown label before the clip is read.
        expected = loaded.gesture(expected).label
    recognizer = Recognizer(loaded, profile)
    for twins in recognizer.undecided_twins:
        tell(ask_twins(twins))
    spots = without_salutes or loaded.trigger.spots
    spotter = Spotter(recognizer, triggered=not without_salutes) if spots else None
    reading = replace(reading, topic=topic)
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
            save_bag(mcap, path, reading, recording, loaded, expected, results)
        show_results(path, recognizer, results, expected, as_json=as_json)
        if not results or not results[-1][0].closed:
            for told in tell_chapters(path.name):
                tell(told)
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
        if expected is not None and expected != NONE
    ]
    if as_json:
        report = {
            "clip": str(path),
            "language": recognizer.language.name,
            "profile": recognizer.profile,
            "takes": [
                {"start": take.start, "end": take.end, "closed": take.closed}
                | result.to_dict()
                | ({} if why is None else {"explanation": why.to_dict()})
                for (take, result), why in zip_longest(results, explanations)
            ],
        }
        typer.echo(json.dumps(report, allow_nan=False))
        return
    for (take, result), explanation in zip_longest(results, explanations):
        show_recognition(take, result, recognizer.language.trigger)
        if expected == NONE:
            tell(f"the take from {take.start:.2f} s shows none of these: {judge_none(result)}")
        if explanation is not None:
            show_explanation(explanation)


def judge_none(result: Recognition) -> str:
    """Say whether an answer to a take of none of the gestures is right."""
    if result.label is not None:
        return f"read as {result.label!r}, wrong"
    return "refused, right" if result.pair is None else "asked about"


def explain_absence(
    path: Path, recording: Recording, recognizer: Recognizer, *, without_salutes: bool
) -> None:
    """Print why a clip has no take, and what to do."""
    seconds = f"{recording.poses.duration:.1f} s"
    if without_salutes:
        tell(
            f"{path}: no gesture of {recognizer.language.name!r} found in {seconds}; "
            f"pause before and after a gesture, or give the range: {path}@START-END"
        )
    elif recognizer.language.trigger == SALUTE:
        poses, odd = recording.poses, tuple(tell_clock(recording.poses.time))
        why = recording.salute_warnings or explain_missing_salutes(
            poses, recording.salute, recording.hands, odd=odd
        )
        reason = next(iter(why), f"no salute found in {seconds}")
        tell(f"{path}: no take: {reason}; or give the range: {path}@START-END")
    else:
        words = recognizer.language.trigger.words
        tell(
            f"{path}: no take {words} found in {seconds}; hold "
            f"the pose for at least {POSE_SECONDS:g} s, or give the range: {path}@START-END"
        )


class TakeEntry(Recognition):
    """A take and its recognition. G gestures and V voters are in the order of their lists."""

    model_config = ConfigDict(extra="allow")

    start: Seconds
    end: Seconds
    closed: bool
    """Whether a salute, or the other trigger, ended it."""
    explanation: dict[str, Any] | None = None
    """Why, and what would change it; only with --expected."""


class RecognitionReport(BaseModel):
    """What ``osg-studio recognize --json`` prints.

    Programs that read a report ignore keys that they do not know.
    """

    model_config = ConfigDict(**DESCRIBED, extra="allow")

    clip: str
    """The file, as it was given."""
    language: str
    """The language's name."""
    profile: ProfileName
    """The set of voters."""
    takes: list[TakeEntry]


def save_bag(
    target: Path,
    clip: Path,
    reading: ClipReading,
    recording: Recording,
    language: Language,
    expected: str | None,
    results: Sequence[tuple[Take, Recognition]],
) -> None:
    """Write a clip and its recognitions to `target`, completely or not at all.

    Parameters
    ----------
    target
        The MCAP file.
    clip, reading
        Source of `recording`, as for `app.cli.clip_argument.read_clip`.
    recording
        Landmarks of the clip.
    language, expected, results
        The language by which its takes were recognised, the label meant if known, and the takes.

    Raises
    ------
    BagError
        When the package that writes MCAP is not installed.

    """
    name, revision = language.name, language.revision
    recognitions = [
        NamedRecognition(take.stroke_start, take.end, name, revision, result, expected)
        for take, result in results
    ]
    path, named = bag_and_topic(str(clip))
    with tempfile.TemporaryDirectory(prefix=f".{target.name}-", dir=target.parent) as made:
        partial = Path(made, "session")
        options = reading.options(named)
        source = source_of(path, options.topic)
        video = source.playable_video(path, options, Path(made, "video"))
        with progress_bar(target.name) as advance:
            write_bag(
                partial,
                recording,
                recognitions,
                video=video,
                name=path.name,
                trigger=language.trigger,
                progress=advance,
            )
        partial.replace(target)
    tell(f"{target}: {decimal(target.stat().st_size)}, opens in Foxglove")
