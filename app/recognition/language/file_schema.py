"""Keys of the language file: pydantic models of version 1 with units and axes.

`LanguageDocument` is the whole file. The JSON Schema published in `schema/` is generated from the
models and from the docstrings below their attributes. The entries of tunings and triggers are
converted here too (`tuning_to_entry`, `entry_to_trigger` and their inverses).
"""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, Field

from app.recognition.decision.outcome import MOST_REFUSED_AT_ALL
from app.recognition.errors import point_to
from app.recognition.features.trajectory_image import SIMPLIFICATION
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS, MAX_DIVER_LENGTH
from app.recognition.gestures.profile import (
    AS_THE_PROFILE,
    DEFAULT_PROFILE,
    MAX_FACTOR,
    MAX_SIMPLIFICATION,
    ProfileName,
    Tuning,
    find_profile,
)
from app.recognition.gestures.switches import Switch
from app.recognition.language.grammar_entry import FiniteFloat, GrammarEntry, Name, Text
from app.recognition.poses.landmarks import HAND_LANDMARKS
from app.recognition.text.described import STRICT
from app.recognition.triggers.trigger import SALUTE, ArmPose, Trigger, TriggerKind
from app.recognition.voters.registry import FORMER_VOTERS, PAPER_VOTERS


def tuning_to_entry(tuning: Tuning) -> TuningEntry | None:
    """Return the file's entry of a tuning; None if it changes nothing."""
    if tuning == AS_THE_PROFILE:
        return None
    return TuningEntry(
        weights=dict(tuning.weights),
        simplification=(None if tuning.simplification == SIMPLIFICATION else tuning.simplification),
        keypoints_repaired=tuning.keypoints_repaired,
    )


def entry_to_tuning(entry: TuningEntry | None, profile: ProfileName = "paper") -> Tuning:
    """Return the tuning of an entry, or the default without one.

    Weight factors for voters that the profile had in an earlier version are left out.
    """
    if entry is None:
        return AS_THE_PROFILE
    former = FORMER_VOTERS | {voter.name for voter in PAPER_VOTERS}
    former -= {voter.name for voter in find_profile(profile).voters}
    return Tuning(
        weights={voter: factor for voter, factor in entry.weights.items() if voter not in former},
        simplification=SIMPLIFICATION if entry.simplification is None else entry.simplification,
        keypoints_repaired=entry.keypoints_repaired,
    )


FORMAT: Final = "osg-studio/gesture-language"
VERSION: Final = 1

MAX_GESTURES = 1000
"""Most gestures, and most demonstrations of all gestures together, which bounds the work; published
languages have at most 20 signs."""

MAX_FILE_BYTES = 64_000_000
"""1000 demonstrations of 40 kB, and half as much again for descriptions and commands."""

MAX_HAND_COORDINATE = 5.0
"""Largest coordinate of a hand: of 21 points of size 1 none is farther from their centroid."""

Landmark = Annotated[str, Field(min_length=1)]
Diver = Annotated[str, Field(max_length=MAX_DIVER_LENGTH)]
HandCoordinates = Annotated[
    list[Annotated[FiniteFloat, Field(ge=-MAX_HAND_COORDINATE, le=MAX_HAND_COORDINATE)]],
    Field(min_length=len(HAND_LANDMARKS), max_length=len(HAND_LANDMARKS)),
]


class _Model(BaseModel):
    model_config = STRICT


Coordinate = Annotated[float, Field(allow_inf_nan=False, ge=-10, le=10)]

PlaceEntry = Annotated[list[Coordinate], Field(min_length=2, max_length=2)]


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


class PathEntry(_Model):
    """One landmark's path."""

    landmark: Landmark
    x: list[FiniteFloat | None]
    """To the image's right, in `unit`, per moment; null = not seen."""
    y: list[FiniteFloat | None]
    """Down, in `unit`, per moment; null = not seen."""
    z: list[FiniteFloat | None] | None = None
    """Away from the camera behind the torso's centre, in `unit`, per moment; null = not known. Left
    out where no landmark's depth is known."""


class HandEntry(_Model):
    """The shape of a held hand, the median of its landmarks over the demonstration."""

    side: Literal["left", "right"]
    """The person's own."""
    x: HandCoordinates
    """Of MediaPipe's 21 hand landmarks, to the image's right; their centroid is 0, their root mean
    squared distance from it 1."""
    y: HandCoordinates
    """The same, down."""


Hands = Annotated[list[HandEntry], Field(max_length=2)]


class TrajectoryEntry(_Model):
    """A demonstration, relative to the torso."""

    unit: Literal["torso_length", "extent"]
    """torso_length: mid-shoulders to mid-hips is 1. extent: the longest diagonal of any landmark's
    bounding box is 1 (no torso was seen)."""
    axes: Literal["x right, y down"]
    """As in the image; the origin is the torso's centre."""
    time: Annotated[list[FiniteFloat], Field(min_length=1)]
    """Seconds since the demonstration's start, strictly increasing."""
    paths: Annotated[list[PathEntry], Field(min_length=1)]
    hands: Hands = []
    """The hands that hold a shape, one or both, where the gesture is a held hand shape and has no
    salient landmarks. Left out in movements."""
    then_hands: Hands = []
    """The same hands with the second shape, where the gesture is a sequence of two held hand
    shapes. Left out in all others."""
    moving_hands: Hands = []
    """The shapes of the hands that carry a movement, one or both. Left out where none is seen for
    long enough, and in held hand shapes."""


Share = Annotated[FiniteFloat, Field(ge=0, le=1)]


class RatesEntry(_Model):
    """How often a gesture's thresholds are expected to err."""

    miss: Share
    """Share of other people's takes that are rejected."""
    false_alarm: Share
    """Share of out-of-vocabulary movements that are accepted."""


EncodedImage = Annotated[str, Field(max_length=100_000)]


class DemonstrationEntry(_Model):
    """A further demonstration of a gesture, with the same keys as the first."""

    salient: list[Landmark]
    """Landmarks whose motion is the gesture in this demonstration; empty where it is a held hand
    shape."""
    trajectory: TrajectoryEntry
    image: EncodedImage
    """224 x 224 PNG in base64: the salient landmarks' paths, or the held hand, white on black."""
    descriptors: dict[str, list[FiniteFloat]]
    """Per voter its description of the image."""
    diver: Diver = ""
    """Name of the diver who shows it. Left out when not known."""


class GestureEntry(_Model):
    """One gesture: its demonstration, and what the recogniser derived from it."""

    label: Name
    """Result of recognition, printable, unique. U+200C and U+200D occur within words only; two
    labels that differ in them alone are the same."""
    description: Text
    command: Text | dict[str, Any] | None
    """What the robot should do: free text, an object, or null."""
    salient: list[Landmark]
    """Landmarks whose motion is the gesture; empty: it is a held hand shape, or without hands
    matches nothing."""
    trajectory: TrajectoryEntry | None
    """null where the gesture was imported from a file of images."""
    image: EncodedImage
    """224 x 224 PNG in base64: the salient landmarks' paths, or the held hand, white on black."""
    descriptors: dict[str, list[FiniteFloat]]
    """Per voter its description of the image."""
    thresholds: dict[str, FiniteFloat]
    """Per voter the distance at which versions up to 0.2 reject the gesture; not used since, and
    computed anew by these versions where empty."""
    rates: RatesEntry | None = None
    """What to expect of the thresholds. Left out when not known."""
    direction: Switch = "auto"
    """Whether the way it is drawn counts; auto: where another gesture is the same figure turned
    round. Left out when auto."""
    tempo: Switch = "auto"
    """Whether the duration counts; auto: where another gesture is the same movement, clearly slower
    or quicker. Left out when auto."""
    mirror: Switch = "auto"
    """on: the mirror image, with the other hand, is the same gesture; auto, off: it is not. Left
    out when auto."""
    hand_shape: Switch = "auto"
    """Whether the shape of the moving hand counts; auto: where another gesture is the same movement
    with a clearly different hand shape. Left out when auto."""
    diver: Diver = ""
    """Name of the diver of the first demonstration. Left out when not known."""
    demonstrations: Annotated[
        list[DemonstrationEntry], Field(max_length=MAX_DEMONSTRATIONS - 1)
    ] = []
    """The demonstrations beside the first. Left out when there are none."""


class TuningEntry(_Model):
    """How recognition deviates from the profile."""

    weights: dict[Name, Annotated[FiniteFloat, Field(ge=0, le=MAX_FACTOR)]] = {}
    """Weight factor per voter, 0: off. Voters left out keep 1."""
    simplification: Annotated[FiniteFloat | None, Field(ge=0, le=MAX_SIMPLIFICATION)] = None
    """Tolerance in pixels with which the paths are simplified before they are drawn. Left out: as
    in `settings`."""
    keypoints_repaired: bool | None = None
    """Whether bad keypoints are repaired before they are looked at. Left out: as the profile
    does."""


class LanguageDocument(_Model):
    """A gesture language for one diver and one robot."""

    format: Literal["osg-studio/gesture-language"]
    version: Literal[1]
    name: Name
    author: Annotated[str, Field(max_length=200)]
    created: Annotated[str, Field(pattern=r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")]
    """UTC, ISO 8601 to the second."""
    revision: Annotated[int, Field(ge=1)]
    """Counts the edits, from 1."""
    skeleton: list[Annotated[list[Landmark], Field(min_length=2, max_length=2)]]
    """Pairs of landmarks joined by a bone, for drawing."""
    settings: dict[str, int | FiniteFloat]
    """What images and descriptors were made with."""
    thresholds_for: Annotated[str, Field(pattern="^([0-9a-f]{8})?$")] = ""
    """Fingerprint of the gestures that the thresholds were made for, in files of version 0.2 and
    before."""
    grammar: GrammarEntry | None = None
    """The phrases. Left out when gestures stand for themselves."""
    profile: ProfileName = DEFAULT_PROFILE
    """The voters that recognise it. Left out when full."""
    tuning: TuningEntry | None = None
    """What differs from the profile. Left out when nothing does."""
    trigger: TriggerEntry | None = None
    """What begins and ends a take. Left out when a salute does."""
    most_refused: Annotated[float | None, Field(gt=0, le=MOST_REFUSED_AT_ALL)] = None
    """Share of right takes that may be refused. Left out when 0.05."""
    gestures: Annotated[list[GestureEntry], Field(max_length=MAX_GESTURES)]
    sha256: Annotated[str | None, Field(pattern="^[0-9a-f]{64}$")] = None
    """Of the canonical JSON (RFC 8785) of everything but this key. A file edited by hand leaves it
    out; saving adds it again."""
