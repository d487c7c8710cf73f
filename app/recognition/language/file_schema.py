"""File schema: pydantic models of the language file, version 1, with units and axes.

The JSON Schema published in `schema/` is generated from them.
"""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, ConfigDict, Field

from app.recognition.decision.rejection import MOST_REFUSED_AT_ALL
from app.recognition.gestures.demonstration import MAX_DEMONSTRATIONS, MAX_DIVER_LENGTH
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH, MAX_TEXT_LENGTH
from app.recognition.gestures.profile import DEFAULT_PROFILE, ProfileName
from app.recognition.gestures.switches import Switch
from app.recognition.gestures.tuning import MAX_FACTOR, MAX_SIMPLIFICATION
from app.recognition.language.grammar_entry import GrammarEntry
from app.recognition.language.trigger_entry import TriggerEntry
from app.recognition.poses.landmarks import HAND_LANDMARKS

FORMAT: Final = "osg-studio/gesture-language"
VERSION: Final = 1

MAX_GESTURES = 1000
"""Most gestures, and most demonstrations of all gestures together, which bounds the work; published
languages have at most 20 signs."""

MAX_FILE_BYTES = 64_000_000
"""1000 demonstrations of 40 kB, and half as much again for descriptions and commands."""

MAX_HAND_COORDINATE = 5.0
"""Largest coordinate of a hand: of 21 points of size 1 none is farther from their centroid."""

Name = Annotated[str, Field(min_length=1, max_length=MAX_LABEL_LENGTH)]
Landmark = Annotated[str, Field(min_length=1)]
Text = Annotated[str, Field(max_length=MAX_TEXT_LENGTH)]
Diver = Annotated[str, Field(max_length=MAX_DIVER_LENGTH)]
FiniteFloat = Annotated[float, Field(allow_inf_nan=False)]
HandCoordinates = Annotated[
    list[Annotated[FiniteFloat, Field(ge=-MAX_HAND_COORDINATE, le=MAX_HAND_COORDINATE)]],
    Field(min_length=len(HAND_LANDMARKS), max_length=len(HAND_LANDMARKS)),
]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class PathEntry(_Model):
    """One landmark's path."""

    landmark: Landmark
    x: Annotated[
        list[FiniteFloat | None],
        Field(description="To the image's right, in `unit`, per moment; null = not seen."),
    ]
    y: Annotated[
        list[FiniteFloat | None],
        Field(description="Down, in `unit`, per moment; null = not seen."),
    ]
    z: Annotated[
        list[FiniteFloat | None] | None,
        Field(
            description="Away from the camera behind the torso's centre, in `unit`, per moment; "
            "null = not known. Left out where no landmark's depth is known."
        ),
    ] = None


class HandEntry(_Model):
    """The shape of a held hand, the median of its landmarks over the demonstration."""

    side: Annotated[Literal["left", "right"], Field(description="The person's own.")]
    x: Annotated[
        HandCoordinates,
        Field(
            description="Of MediaPipe's 21 hand landmarks, to the image's right; their centroid is "
            "0, their root mean squared distance from it 1."
        ),
    ]
    y: Annotated[HandCoordinates, Field(description="The same, down.")]


class TrajectoryEntry(_Model):
    """A demonstration, relative to the torso."""

    unit: Annotated[
        Literal["torso_length", "extent"],
        Field(
            description="torso_length: mid-shoulders to mid-hips is 1. extent: the longest "
            "diagonal of any landmark's bounding box is 1 (no torso was seen)."
        ),
    ]
    axes: Annotated[
        Literal["x right, y down"],
        Field(description="As in the image; the origin is the torso's centre."),
    ]
    time: Annotated[
        list[FiniteFloat],
        Field(
            min_length=1,
            description="Seconds since the demonstration's start, strictly increasing.",
        ),
    ]
    paths: Annotated[list[PathEntry], Field(min_length=1)]
    hands: Annotated[
        list[HandEntry],
        Field(
            max_length=2,
            description="The hands that hold a shape, one or both, where the gesture is a held "
            "hand shape and has no salient landmarks. Left out in movements.",
        ),
    ] = []
    then_hands: Annotated[
        list[HandEntry],
        Field(
            max_length=2,
            description="The same hands with the second shape, where the gesture is a sequence of "
            "two held hand shapes. Left out in all others.",
        ),
    ] = []
    moving_hands: Annotated[
        list[HandEntry],
        Field(
            max_length=2,
            description="The shapes of the hands that carry a movement, one or both. Left out "
            "where none is seen for long enough, and in held hand shapes.",
        ),
    ] = []


class RatesEntry(_Model):
    """How often a gesture's thresholds are expected to err."""

    miss: Annotated[
        FiniteFloat,
        Field(ge=0, le=1, description="Share of other people's takes that are rejected."),
    ]
    false_alarm: Annotated[
        FiniteFloat,
        Field(ge=0, le=1, description="Share of out-of-vocabulary movements that are accepted."),
    ]


EncodedImage = Annotated[
    str,
    Field(
        max_length=100_000,
        description="224 x 224 PNG in base64: the salient landmarks' paths, or the held hand, "
        "white on black.",
    ),
]

Descriptors = Annotated[
    dict[str, list[FiniteFloat]],
    Field(description="Per voter its description of the image."),
]


class DemonstrationEntry(_Model):
    """A further demonstration of a gesture, with the same keys as the first."""

    salient: Annotated[
        list[Landmark],
        Field(
            description="Landmarks whose motion is the gesture in this demonstration; empty where "
            "it is a held hand shape.",
        ),
    ]
    trajectory: TrajectoryEntry
    image: EncodedImage
    descriptors: Descriptors
    diver: Annotated[
        Diver, Field(description="Name of the diver who shows it. Left out when not known.")
    ] = ""


class GestureEntry(_Model):
    """One gesture: its demonstration, and what the recogniser derived from it."""

    label: Annotated[
        Name,
        Field(
            description="Result of recognition, printable, unique. U+200C and U+200D occur within "
            "words only; two labels that differ in them alone are the same."
        ),
    ]
    description: Text
    command: Annotated[
        Text | dict[str, Any] | None,
        Field(description="What the robot should do: free text, an object, or null."),
    ]
    salient: Annotated[
        list[Landmark],
        Field(
            description="Landmarks whose motion is the gesture; empty: it is a held hand shape, or "
            "without hands matches nothing."
        ),
    ]
    trajectory: Annotated[
        TrajectoryEntry | None,
        Field(description="null where the gesture was imported from a file of images."),
    ]
    image: EncodedImage
    descriptors: Descriptors
    thresholds: Annotated[
        dict[str, FiniteFloat],
        Field(
            description="Per voter the distance at which versions up to 0.2 reject the gesture; "
            "not used since, and computed anew by these versions where empty."
        ),
    ]
    rates: Annotated[
        RatesEntry | None,
        Field(description="What to expect of the thresholds. Left out when not known."),
    ] = None
    direction: Annotated[
        Switch,
        Field(
            description="Whether the way it is drawn counts; auto: where another gesture is the "
            "same figure turned round. Left out when auto."
        ),
    ] = "auto"
    tempo: Annotated[
        Switch,
        Field(
            description="Whether the duration counts; auto: where another gesture is the same "
            "movement, clearly slower or quicker. Left out when auto."
        ),
    ] = "auto"
    mirror: Annotated[
        Switch,
        Field(
            description="on: the mirror image, with the other hand, is the same gesture; auto, "
            "off: it is not. Left out when auto."
        ),
    ] = "auto"
    hand_shape: Annotated[
        Switch,
        Field(
            description="Whether the shape of the moving hand counts; auto: where another gesture "
            "is the same movement with a clearly different hand shape. Left out when auto."
        ),
    ] = "auto"
    diver: Annotated[
        Diver,
        Field(description="Name of the diver of the first demonstration. Left out when not known."),
    ] = ""
    demonstrations: Annotated[
        list[DemonstrationEntry],
        Field(
            max_length=MAX_DEMONSTRATIONS - 1,
            description="The demonstrations beside the first. Left out when there are none.",
        ),
    ] = []


class TuningEntry(_Model):
    """How recognition deviates from the profile."""

    weights: Annotated[
        dict[Name, Annotated[FiniteFloat, Field(ge=0, le=MAX_FACTOR)]],
        Field(description="Weight factor per voter, 0: off. Voters left out keep 1."),
    ] = {}
    simplification: Annotated[
        FiniteFloat | None,
        Field(
            ge=0,
            le=MAX_SIMPLIFICATION,
            description="Tolerance in pixels with which the paths are simplified before they are "
            "drawn. Left out: as in `settings`.",
        ),
    ] = None
    keypoints_repaired: Annotated[
        bool | None,
        Field(
            description="Whether bad keypoints are repaired before they are looked at. Left out: "
            "as the profile does."
        ),
    ] = None


class LanguageDocument(_Model):
    """A gesture language for one diver and one robot."""

    format: Literal["osg-studio/gesture-language"]
    version: Literal[1]
    name: Name
    author: Annotated[str, Field(max_length=200)]
    created: Annotated[
        str,
        Field(
            pattern=r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$",
            description="UTC, ISO 8601 to the second.",
        ),
    ]
    revision: Annotated[int, Field(ge=1, description="Counts the edits, from 1.")]
    skeleton: Annotated[
        list[Annotated[list[Landmark], Field(min_length=2, max_length=2)]],
        Field(description="Pairs of landmarks joined by a bone, for drawing."),
    ]
    settings: Annotated[
        dict[str, int | FiniteFloat],
        Field(description="What images and descriptors were made with."),
    ]
    thresholds_for: Annotated[
        str,
        Field(
            pattern="^([0-9a-f]{8})?$",
            description="Fingerprint of the gestures that the thresholds were made for, in files "
            "of version 0.2 and before.",
        ),
    ] = ""
    grammar: Annotated[
        GrammarEntry | None,
        Field(description="The phrases. Left out when gestures stand for themselves."),
    ] = None
    profile: Annotated[
        ProfileName,
        Field(description="The voters that recognise it. Left out when full."),
    ] = DEFAULT_PROFILE
    tuning: Annotated[
        TuningEntry | None,
        Field(description="What differs from the profile. Left out when nothing does."),
    ] = None
    trigger: Annotated[
        TriggerEntry | None,
        Field(description="What begins and ends a take. Left out when a salute does."),
    ] = None
    most_refused: Annotated[
        float | None,
        Field(
            gt=0,
            le=MOST_REFUSED_AT_ALL,
            description="Share of right takes that may be refused. Left out when 0.05.",
        ),
    ] = None
    gestures: Annotated[list[GestureEntry], Field(max_length=MAX_GESTURES)]
    sha256: Annotated[
        str | None,
        Field(
            pattern="^[0-9a-f]{64}$",
            description="Of the canonical JSON (RFC 8785) of everything but this key. A file "
            "edited by hand leaves it out; saving adds it again.",
        ),
    ] = None
