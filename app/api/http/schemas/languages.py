"""The JSON that goes in and out, as pydantic models; `/openapi.json` is made from them."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from app.api.extraction.messages import Pose, TopicSeen
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH, MAX_TEXT_LENGTH
from app.recognition.gestures.profile import ProfileName
from app.recognition.language.grammar_schema import GrammarEntry
from app.recognition.language.language import MAX_AUTHOR_LENGTH, MAX_NAME_LENGTH
from app.recognition.language.schema import TuningEntry
from app.store import JobStatus

MOST_SECONDS = 24 * 60 * 60
"""No clip is a day long; beyond it a number of seconds is a mistake."""

Name = Annotated[str, Field(min_length=1, max_length=MAX_NAME_LENGTH, pattern=r"\S")]
Author = Annotated[str, Field(max_length=MAX_AUTHOR_LENGTH)]
Label = Annotated[str, Field(min_length=1, max_length=MAX_LABEL_LENGTH, pattern=r"\S")]
Seconds = Annotated[float, Field(ge=0, le=MOST_SECONDS, allow_inf_nan=False)]
Identifier = Annotated[str, Field(min_length=1, max_length=64)]
Landmarks = Annotated[list[Annotated[str, Field(max_length=64)]], Field(max_length=64)]
Command = Annotated[str, Field(max_length=MAX_TEXT_LENGTH)] | dict[str, Any] | None


class Body(BaseModel):
    """Base of request bodies: unknown members are mistakes, and are said to be."""

    model_config = ConfigDict(extra="forbid")


class ClipAccepted(BaseModel):
    """A clip was stored; its poses are extracted by the job."""

    id: str
    job_id: str


class ClipView(BaseModel):
    """A clip, and how far the extraction of its poses is."""

    id: str
    name: str = Field(description="As the sender called the file, without what could do harm")
    status: JobStatus
    error: str | None = Field(description="Why there are no poses, when the job failed")
    error_code: str | None
    warnings: list[str] = Field(description="What was found wanting in the clip")
    width: int = Field(description="Pixels of the upright picture")
    height: int
    duration: float | None = Field(description="Seconds, where the container says")
    frames: int | None = Field(description="Frames decoded; before that, as the container says")
    size: int = Field(description="Bytes")
    media_type: str
    topics: list[TopicSeen] = Field(
        description="Of a dive recording: what a clip can be made of; empty for a video"
    )
    topic: str | None = Field(
        description="Of a dive recording: what the clip is made of; null while nobody chose"
    )
    shows_pictures: bool = Field(
        description="Whether its video shows the diver; else it shows the keypoints that came"
    )
    job_id: str
    created: datetime


class TopicChoice(BaseModel):
    """Which topic of a dive recording a clip is to be made of."""

    model_config = ConfigDict(extra="forbid")

    topic: Annotated[str, Field(min_length=1, max_length=255)]


class JobView(BaseModel):
    """How far a job is."""

    id: str
    clip_id: str
    status: JobStatus
    stage: str = Field(description="queued, starting, poses, saving, or the final status")
    done: int = Field(description="Frames")
    total: int = Field(description="Frames; an estimate where the container does not count them")
    eta_s: float | None = Field(description="Seconds left at the present rate")
    time: float | None = Field(
        description="Seconds after the clip's first frame, of the frame that `pose` was found in; "
        "null in every stage but poses"
    )
    pose: Pose | None = Field(
        description="The newest pose: of each of the 33 landmarks of the body (in the order of "
        "`landmarks` in a clip's poses) x and y as fractions of the picture's width and height, "
        "x right, y down; null: not seen. Null as a whole where nobody is in the frame"
    )
    error: str | None
    error_code: str | None
    created: datetime
    started: datetime | None
    finished: datetime | None


class PosesView(BaseModel):
    """Landmarks in every frame of a clip."""

    landmarks: list[str]
    time: list[float] = Field(description="Seconds since the first frame, one per frame")
    xy: list[list[list[float | None]]] = Field(
        description="Frames x landmarks x 2: pixels, x right, y down; null: not seen"
    )
    confidence: list[list[float]] | None = Field(description="Frames x landmarks, 0 to 1")
    frame_size: Annotated[list[int], Field(min_length=2, max_length=2)] = Field(
        description="Width and height in pixels"
    )


class TakeView(BaseModel):
    """What lies between two salutes, in seconds of the clip."""

    start: float
    end: float
    closed: bool = Field(description="Whether a second salute ended it")
    stroke_start: float = Field(description="Where the gesture begins: after the hand's way to it")
    stroke_end: float


class LanguageDraft(Body):
    """A new language."""

    name: Name
    author: Author = ""


class LanguageChange(Body):
    """What to change about a language; what is left out stays."""

    name: Name | None = None
    author: Author | None = None
    grammar: GrammarEntry | None = Field(default=None, description="The phrases; null: none")
    profile: ProfileName | None = Field(default=None, description="The voters that recognise it")
    tuning: TuningEntry | None = Field(
        default=None, description="What differs from the profile; null: nothing"
    )


class LanguageRevert(Body):
    """Which revision to go back to."""

    revision: Annotated[int, Field(ge=0, le=2**31 - 1)]


SwitchPosition = Literal["auto", "on", "off"]


class NewDemonstration(Body):
    """Where the demonstration of a gesture is."""

    clip_id: Identifier
    start: Seconds | None = None
    end: Seconds | None = None
    keep_transit: bool = Field(
        default=False,
        description="Keep the hand's way from and to the salute, where the range is a take's own",
    )


class GestureDraft(NewDemonstration):
    """A gesture to save from a clip."""

    label: Label
    salient: Landmarks | None = None
    direction: SwitchPosition = "auto"
    tempo: SwitchPosition = "auto"
    mirror: SwitchPosition = "auto"
    description: Annotated[str, Field(max_length=MAX_TEXT_LENGTH)] = ""
    command: Command = None


class GestureChange(Body):
    """What to change about a gesture; what is left out stays."""

    label: Label | None = None
    demonstration: NewDemonstration | None = Field(
        default=None, description="Takes the place of the one that made the gesture"
    )
    direction: SwitchPosition | None = None
    tempo: SwitchPosition | None = None
    mirror: SwitchPosition | None = None
    salient: Landmarks | None = None
    description: Annotated[str, Field(max_length=MAX_TEXT_LENGTH)] | None = None
    command: Command = None


class SourceView(BaseModel):
    """Where a demonstration comes from."""

    clip_id: str
    start: float = Field(description="Seconds in the clip")
    end: float
    keep_transit: bool


class GestureView(BaseModel):
    """A gesture of a language."""

    label: str
    description: str
    command: str | dict[str, Any] | None
    salient: list[str]
    direction: SwitchPosition
    tempo: SwitchPosition
    mirror: SwitchPosition
    thumbnail: str = Field(description="Path of its trajectory image, a PNG")
    has_trajectory: bool = Field(description="False when imported from a file that has none")
    source: SourceView | None = Field(
        default=None, description="The clip of its demonstration; null: not known, or deleted"
    )


class LanguageSummary(BaseModel):
    """A language in a list."""

    id: str
    name: str
    author: str
    revision: int
    change: str = Field(description="What the newest revision did")
    labels: list[str]
    sample: bool = Field(description="Whether it came with the program")
    created: datetime
    updated: datetime


class LanguageView(LanguageSummary):
    """A language with its gestures."""

    gestures: list[GestureView]
    grammar: GrammarEntry | None = Field(description="Null: gestures stand for themselves")
    profile: ProfileName = Field(description="The voters that recognise it")
    tuning: TuningEntry | None = Field(description="What differs from the profile; null: nothing")
    tuning_words: str = Field(description="The same for people: recognised ...")


class RevisionView(BaseModel):
    """One revision in a language's history."""

    revision: int
    name: str
    author: str
    labels: list[str]
    change: str
    created: datetime


class GestureComparison(BaseModel):
    """A gesture in two revisions of its language."""

    kind: Literal["added", "removed", "changed", "same"]
    before: GestureView | None = Field(description="Null: the older revision does not have it")
    after: GestureView | None = Field(description="Null: the newer revision does not have it")
    words: list[str] = Field(description="What changed about it, a sentence each")


class RevisionComparison(BaseModel):
    """Two revisions of a language, side by side."""

    older: RevisionView | None = Field(description="Null: compared with nothing")
    newer: RevisionView
    words: list[str] = Field(description="What changed about the language itself")
    gestures: list[GestureComparison] = Field(
        description="In the newer revision's order, then those it does not have any more"
    )


class RecognitionRequest(Body):
    """What to recognise."""

    clip_id: Identifier
    language_id: Identifier
    start: Seconds | None = None
    end: Seconds | None = None
    profile: Annotated[str, Field(max_length=32)] | None = Field(
        default=None, description="Null: the language's own"
    )
    tuning: TuningEntry | None = Field(default=None, description="Null: as the language says")
    expected: Label | None = None


class RecognitionView(BaseModel):
    """The full answer of a recognition, kept as a record."""

    model_config = ConfigDict(extra="allow")

    id: str
    clip_id: str
    language_id: str
    revision: int
    start: float
    end: float
    profile: str
    tuning: TuningEntry | None = Field(default=None, description="Null: as the language says")
    expected: str | None
    created: datetime
    label: str | None = Field(description="None when rejected")
    nearest: str | None = Field(description="The best label even when rejected")
    confidence: float
    voters: list[str]
    gestures: list[str]
    distances: list[list[float | None]] = Field(
        description="Voters x gestures, smaller: more alike"
    )
    votes: dict[str, str | None] = Field(description="Each voter's nearest gesture")
    weights: dict[str, float] = Field(
        default_factory=dict, description="Each voter's share in the decision; 0: has no say"
    )
    findings: list[str] = Field(default_factory=list, description="What was repaired, in sentences")
    fault: str | None = Field(None, description="Why the recording is too poor to judge, in words")


class ExplanationView(BaseModel):
    """Why a recognition came out as it did."""

    model_config = ConfigDict(extra="allow")

    id: str = Field(description="The recognition's")
    profile: str
    expected: str
    label: str | None
    nearest: str
    right: bool
    confidence: float
    other: str | None = Field(description="The gesture that the expected one is held against")
    margin: float | None = Field(description="Score of the other minus that of the expected")
    sentence: str
    votes: dict[str, int]
    verdicts: list[dict[str, Any]] = Field(description="Per voter, the most against it first")
    alignments: list[dict[str, Any]]
    differences: list[dict[str, Any]]
    counterfactuals: list[dict[str, Any]] = Field(description="Verified, the smallest first")
    tried: int


class SampleView(BaseModel):
    """A clip that comes with the program."""

    name: str
    size: int = Field(description="Bytes")


class SampleLanguageView(BaseModel):
    """A language that comes with the program."""

    name: str = Field(description="By which it is asked for")
    title: str = Field(description="The language's own name")
    labels: list[str]


class SampleChoice(Body):
    """Which sample to add."""

    name: Annotated[str, Field(min_length=1, max_length=200)]


class Health(BaseModel):
    """Whether the server works."""

    status: str = Field(description="ok, or models_missing: then clips cannot be extracted")
    version: str
    models: dict[str, str] = Field(description="ok, missing or damaged, per model file")
