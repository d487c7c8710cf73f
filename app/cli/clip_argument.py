"""Clip arguments: parses the arguments that name clips, and reads the clips' landmarks."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, replace
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import Annotated, Any

import typer

from app.bags import bag_and_topic
from app.cli.terminal import progress_bar, tell
from app.clip_sources import ReadOptions, source_of
from app.keypoint_files import KeypointOptions
from app.recognition import Language, Recognition, Recognizer, Recording, Take, takes_in
from app.recognition.errors import GestureError, KeypointFileError
from app.recognition.estimation.factory import MEDIAPIPE_HANDS, create_estimator, list_landmarks
from app.recognition.estimation.water import WaterCorrection
from app.recognition.language.requirements import require_landmarks
from app.recognition.recording.clip_range import find_unseen_in
from app.recognition.recording.segmentation import LONGEST_TAKE
from app.recognition.recording.video import Turn
from app.recognition.spotting import Spotter
from app.recognition.triggers.trigger import SALUTE, Trigger

FrameRateOption = Annotated[
    float | None,
    typer.Option(
        metavar="RATE", help="Frames a second of a keypoint file's video, where it counts frames."
    ),
]

FrameSizeOption = Annotated[
    str | None,
    typer.Option(
        metavar="WIDTHxHEIGHT", help="Pixels of a keypoint file's video, where it has fractions."
    ),
]

LandmarkOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=LANDMARK", help="What a keypoint file's name means here; repeat for more."
    ),
]

KeypointsOption = Annotated[
    str | None,
    typer.Option(
        metavar="SET",
        help="Set of a file's keypoints without names: body25, coco, halpe, mediapipe, ...",
    ),
]


TriggerOption = Annotated[
    Path | None,
    typer.Option(
        "--trigger",
        metavar="FILE",
        help="Language file whose trigger begins and ends the takes of the clips; by default a "
        "salute. See osg-studio trigger.",
    ),
]

TurnOption = Annotated[
    Turn,
    typer.Option(
        metavar="DEGREES",
        help="Turn the pictures clockwise first, by 90, 180 or 270: the camera was turned.",
    ),
]

OutputOption = Annotated[
    Path | None, typer.Option(help="Language file to write; by default the same file.")
]

DiverOption = Annotated[
    str, typer.Option(metavar="NAME", help="Name of the diver who shows all given clips.")
]


def read_options(
    frame_rate: float | None,
    frame_size: str | None,
    landmark: list[str] | None,
    turn: Turn,
    water: WaterCorrection = "auto",
    keypoints: str | None = None,
) -> ReadOptions:
    """Parse the user's options for files; the first three are for keypoint files.

    Raises
    ------
    KeypointFileError
        When a size is not WIDTHxHEIGHT or a landmark not NAME=LANDMARK, or `KeypointOptions`
        refuses a value.

    """
    size = None
    if frame_size is not None:
        match = re.fullmatch(r"(\d{1,5})x(\d{1,5})", frame_size.strip().lower())
        if match is None:
            raise KeypointFileError(f"{frame_size!r} is no size; give WIDTHxHEIGHT, as 1920x1080")
        size = int(match[1]), int(match[2])
    names = {}
    for pair in landmark or ():
        name, equals, meant = (part.strip() for part in pair.rpartition("="))
        if not equals or not name or not meant:
            raise KeypointFileError(
                f"{pair!r} is not NAME=LANDMARK; say what a name means, as in paw=right_wrist"
            )
        names[name] = meant
    given = KeypointOptions(frame_rate, size, names, keypoints)
    return ReadOptions(**vars(given), turn=turn, water=water)


@dataclass(frozen=True)
class ClipReading:
    """Options for reading the landmarks of clips.

    Attributes
    ----------
    file
        How their files are read.
    estimator, hands
        Names of the estimators of body and hands, see `create_estimator`.
    topic
        Topic of a dive recording; None for the one that the clip names, or the only one.
    trigger
        What begins and ends their takes.

    """

    file: ReadOptions
    estimator: str
    hands: str
    topic: str | None = None
    trigger: Trigger = SALUTE

    def options(self, topic: str | None) -> ReadOptions:
        """Return the options for a clip source; `topic` is the one that the clip names."""
        return self.file.model_copy(update={"topic": self.topic or topic})


@dataclass(frozen=True, eq=False)
class ReadClip:
    """Landmarks read from a clip.

    Attributes
    ----------
    recording
        The landmarks.
    salutes
        Whether its source can show a hand, and so a salute.
    trigger
        What begins and ends its takes.

    """

    recording: Recording
    salutes: bool
    trigger: Trigger = SALUTE

    def takes(self, span: tuple[float, float] | None) -> list[Take]:
        """Return the range given by hand, or the takes between salutes or other triggers.

        The whole recording is one take if its source cannot show a salute, or without a trigger.

        Raises
        ------
        GestureError
            When fewer than two frames are left, or the whole is longer than a gesture may be.

        """
        if span is not None:
            return [take_by_hand(self.recording, span)]
        if self.trigger.kind == "pose" or (self.trigger.kind == "salute" and self.salutes):
            return list(takes_in(self.recording, trigger=self.trigger))
        poses = self.recording.poses
        if poses.duration > LONGEST_TAKE:
            spots = self.trigger.spots
            lack = "has no trigger that is held" if spots else "without hands has no salutes"
            raise GestureError(
                f"a recording of {poses.duration:.0f} s {lack} to cut it at, and a gesture lasts "
                f"at most {LONGEST_TAKE:g} s; give the range by hand, CLIP@START-END, or find "
                f"gestures anywhere with --without-salutes"
            )
        return [take_by_hand(self.recording, (float(poses.time[0]), float(poses.time[-1])))]


def clip_and_span(text: str) -> tuple[Path, tuple[float, float] | None]:
    """Split ``CLIP@START-END`` (seconds); an existing file of that name is taken as it is."""
    number = r"\d+(?:\.\d+)?"
    match = re.fullmatch(rf"(.+)@({number})-({number})", text)
    if match is None or Path(text).exists():
        return Path(text), None
    return Path(match[1]), (float(match[2]), float(match[3]))


def take_by_hand(recording: Recording, span: tuple[float, float]) -> Take:
    """Create a take from the user's range, in seconds of the clip; nothing is trimmed.

    Raises
    ------
    GestureError
        When fewer than two frames lie in the range.

    """
    start, end = span
    poses = recording.poses.between(start, end)
    if len(poses) < 2:
        last = recording.poses.time[-1]
        raise GestureError(
            f"{start:g}-{end:g} s holds {len(poses)} frames of a clip that ends at {last:.2f} s; "
            "give START < END inside the clip"
        )
    return Take(
        start=start,
        end=end,
        closed=True,
        poses=poses,
        stroke_start=start,
        stroke_end=end,
        untrimmed=poses,
        unseen=find_unseen_in(recording.poses, (), start, end),
    )


def read_clip(clip: Path, reading: ClipReading, language: Language | None = None) -> ReadClip:
    """Read a clip's landmarks, and print the facts and warnings about the recording.

    Parameters
    ----------
    clip
        A video, whose landmarks are found behind a progress bar; a dive recording as ``BAG`` or
        ``BAG@/TOPIC``; or a keypoint file or folder of another program (`app.keypoint_files`).
    reading
        Options for reading.
    language
        Language to recognise: a source without the landmarks that it needs is refused before any
        recognition, and before a model processes any frame.

    Raises
    ------
    LandmarkError
        When the source lacks a landmark of the language.
    VideoError, KeypointFileError
        When there is no clip, or it cannot be read.
    BagError
        When it is a dive recording and cannot be read, or has no such topic.

    """
    if language is not None:
        reading = replace(reading, trigger=language.trigger)
    path, named = bag_and_topic(str(clip))
    options = reading.options(named)
    source = source_of(path, options.topic)
    if source.shows_pictures(path, options):
        with closing(create_estimator(reading.estimator, hands=reading.hands)) as estimator:
            if language is not None:
                name = f"estimator {reading.estimator}"
                require_landmarks(language, list_landmarks(estimator), name)
            with progress_bar(path.name) as advance:
                read = source.record(path, options, estimator=estimator, progress=advance)
    else:  # recorded keypoints, of which the landmarks are only known after reading
        read = source.record(path, options)
        if language is not None:
            name = f"{path}@{options.topic}" if options.topic else str(path)
            require_landmarks(language, read.landmarks, name)
    for warning in read.recording.list_warnings(reading.trigger):
        tell(f"{clip}: {warning}")
    return ReadClip(read.recording, read.has_hands, reading.trigger)


WaterOption = Annotated[
    WaterCorrection,
    typer.Option(help="Correct colour and contrast: as the models see most, always, or never."),
]

EstimatorOption = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help="Finds the body: onnx, mediapipe, or yolo-pose:FILE.onnx, an Ultralytics export.",
    ),
]

HandsOption = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help="Finds the hands: mediapipe, none, or DETECTOR.onnx,KEYPOINTS.onnx, the paper's pair.",
    ),
]


def takes_options(
    name: str, build: Callable[..., object]
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Decorate a command with the options that are the parameters of `build`.

    The command gets what `build` makes of them as the argument `name`.
    """
    options = signature(build, eval_str=True).parameters

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def run(**given: Any) -> None:
            built = build(**{each: given.pop(each) for each in options})
            command(**given, **{name: built})

        known = signature(command, eval_str=True)
        own = [each for each in known.parameters.values() if each.name != name]
        asked = [each.replace(kind=Parameter.KEYWORD_ONLY) for each in (*own, *options.values())]
        run.__signature__ = known.replace(parameters=asked)  # type: ignore[attr-defined]
        run.__annotations__ = {each.name: each.annotation for each in asked}
        return run

    return decorate


def _build_reading(
    *,
    water: WaterOption = "auto",
    turn: TurnOption = 0,
    estimator: EstimatorOption = "onnx",
    hands: HandsOption = MEDIAPIPE_HANDS,
    frame_rate: FrameRateOption = None,
    frame_size: FrameSizeOption = None,
    landmark: LandmarkOption = None,
    keypoints: KeypointsOption = None,
) -> ClipReading:
    options = read_options(frame_rate, frame_size, landmark, turn, water, keypoints)
    return ClipReading(options, estimator, hands)


reads_clips = takes_options("reading", _build_reading)
"""Decorates a command with the options for reading clips, which it gets as ``reading``."""


def recognize_clip(
    clip: Path,
    span: tuple[float, float] | None,
    reading: ClipReading,
    recognizer: Recognizer,
    spotter: Spotter | None,
) -> tuple[Recording, list[tuple[Take, Recognition]]]:
    """Read a clip and recognise its takes; with a spotter, gestures without salutes.

    Raises
    ------
    OsgError
        When the clip cannot be read; see `read_clip`.

    """
    read = read_clip(clip, reading, recognizer.language)
    if spotter is not None:
        return read.recording, spot_takes(spotter, read.recording, span)
    takes = read.takes(span)
    return read.recording, [(take, recognizer.recognize_take(take)) for take in takes]


def spot_takes(
    spotter: Spotter, recording: Recording, span: tuple[float, float] | None
) -> list[tuple[Take, Recognition]]:
    """Find the gestures in a recording, or in a range of it, without salutes around them."""
    poses = recording.poses.between(*span) if span else recording.poses
    return [
        (take_by_hand(recording, (found.start, found.end)), found.recognition)
        for found in spotter.for_stream().listen(poses)
    ]
