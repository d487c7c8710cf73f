"""Robot events: one frozen dataclass for each kind of event that the runtime emits, in order.

The fields are also the keys of the JSON line of an event: `app.robot.event_messages` derives the
JSON models and the published JSON Schema from annotations, the docstrings below the fields, and the
first line of each class's docstring.
Every `time` is in seconds of the source's clock, of the frame after which the event was known.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from datetime import datetime
from typing import Annotated, Any, Final, Literal

from pydantic import BeforeValidator, Field

from app.recognition import Recognition
from app.recognition.language.file import short_code
from app.recognition.phrases.parser import PhraseEvent
from app.recognition.recording.segmentation import TakeState
from app.robot.commands.replies import Reply

JSON_TYPE: Final = "json_type"
"""Metadata key of a field whose type in JSON is another one; None: the field is not in JSON."""


def _replace_infinity(value: float | None) -> float | None:
    return value if value is None or math.isfinite(value) else None


Seconds = Annotated[float, Field(description="Seconds of the source's clock.")]
Reason = Annotated[str, Field(description="One sentence for a person.")]
Share = Annotated[float, Field(ge=0, le=1)]
Sha256 = Annotated[
    str, Field(pattern="^[0-9a-f]{64}$", description="The language's id: the seal of its file.")
]
Revision = Annotated[int, Field(ge=1, description="The language's revision.")]
Count = Annotated[int, Field(ge=0)]
Margin = Annotated[
    float | None,
    BeforeValidator(_replace_infinity),
    Field(
        description="How much nearer the nearest gesture is than every other, in the unit of the "
        "recogniser's scores; null where no other can be compared."
    ),
]
CommandValue = Annotated[
    str | dict[str, Any] | None,
    Field(description="What the language's author wants the robot to do."),
]


@dataclass(frozen=True, eq=False)
class Event:
    """Base of the events, and of nothing else: `__subclasses__` lists them in order."""

    time: Seconds


@dataclass(frozen=True)
class SourceOpened(Event):
    """Frames are about to be looked at; the first line."""

    source: str
    """Its name, without passwords."""
    live: bool
    """Whether frames may be dropped."""
    frame_size: tuple[int, int]
    """Width and height in pixels."""
    began: datetime | None
    """When the source's clock was 0, in UTC; null for a recording."""


@dataclass(frozen=True)
class SourceWarned(Event):
    """Something is wrong with the source that does not stop it.

    An example is a damaged clip.
    """

    reason: Reason


@dataclass(frozen=True)
class SourceLost(Event):
    """A camera gives no frames any more and is being opened again; a take begun is rejected."""

    reason: Reason


@dataclass(frozen=True)
class SourceRestored(Event):
    """A lost camera gives frames again."""

    missing: float
    """Seconds without a frame."""
    attempts: Annotated[int, Field(ge=1)]
    """How often opening was tried."""


@dataclass(frozen=True)
class SourceEnded(Event):
    """The recording is over, or the robot was stopped; after it only a vehicle may report."""

    frames: Count
    """Looked at."""
    dropped: Count
    """Left out because newer ones had come."""
    stopped: bool
    """By a signal, before the source was over."""


@dataclass(frozen=True)
class FramesDropped(Event):
    """The camera is faster than this machine.

    Emitted at most once in `app.robot.runtime.REPORT_SECONDS`.
    """

    seconds: float
    """Since when is counted."""
    dropped: Count
    frames: Count
    """Looked at in this time."""


@dataclass(frozen=True)
class Heartbeat(Event):
    """The runtime works; of live sources alone, at least every 5 seconds.

    A supervisor that reads none for longer starts the robot again.
    """

    frames: Count
    """Looked at since the beginning."""
    dropped: Count
    """Left out since the beginning."""
    lost: bool
    """Whether the source gives no frames at present."""


@dataclass(frozen=True)
class RecognitionReady(Event):
    """The models have processed their first frame: from now on gestures are seen."""


@dataclass(frozen=True)
class FrameRateChanged(Event):
    """The processed frames are too few a second to recognise gestures, or enough again.

    Emitted when that changes, for the rate in `app.robot.runtime.RATE_SECONDS`.
    """

    frames_per_second: Annotated[float, Field(ge=0)]
    """Frames looked at in a second."""
    sufficient: bool
    """Whether gestures can be recognised."""

    @property
    def words(self) -> str:
        """The event in words."""
        rate = f"{self.frames_per_second:.1f} frames a second"
        return f"enough again: {rate}" if self.sufficient else f"too slow for gestures: {rate}"


@dataclass(frozen=True)
class OutputFailed(Event):
    """A log cannot be written any more; everything else goes on."""

    output: Literal["stdout", "stderr"]
    """What is not written any more."""
    reason: Reason


@dataclass(frozen=True)
class VehicleReported(Event):
    """A line about the vehicle: what was asked of it, and what it did."""

    text: str
    """In words, for the diver and the pilot."""


@dataclass(frozen=True)
class AnswerGiven(Event):
    """The robot answers the diver, by the pulses that the vehicle table lets him see."""

    answer: Reply
    """listening: a gesture, or the next one of a message, is awaited. repeat: the same again
    confirms. one_of_two: showing the one that was meant confirms it. done: the vehicle has done
    it, or it is cancelled. refused: not understood, refused or failed."""
    pulses: Annotated[int, Field(ge=1)]
    """Blinks of the lights, nods of the camera."""
    text: str
    """In words, for the diver and the pilot."""


@dataclass(frozen=True)
class StateChanged(Event):
    """Another state of the salutes."""

    state: TakeState
    """idle: a salute, or without salutes a gesture, is awaited; recording: a take goes on;
    done: the salute that ended it is still held."""


@dataclass(frozen=True)
class LanguageChanged(Event):
    """From now on takes are recognised by this language; the second line, and after a reload."""

    name: str
    sha256: Sha256
    revision: Revision
    gestures: tuple[str, ...]
    """The labels."""
    profile: str
    """The voters that recognise it."""
    tuning: str
    """What differs from that, in words: "recognised ..."."""
    undecided_twins: tuple[tuple[str, str], ...] = ()
    """Gestures of nearly the same movement with different hands; the robot asks back for both."""
    code: str = field(init=False, default="")
    """Short code of `sha256`, which the studio shows too."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "code", short_code(self.sha256))


@dataclass(frozen=True)
class LanguageRefused(Event):
    """A new language file cannot be used; the language told here is kept.

    `sha256` and `revision` are those of the language that stays active.
    """

    reason: Reason
    sha256: Sha256
    revision: Revision


@dataclass(frozen=True, kw_only=True, eq=False)
class TakeRecognized(Event):
    """A gesture was shown.

    Attributes
    ----------
    start, end
        Seconds of the gesture, as ``osg-studio recognize`` prints them.
    closed
        Always true: a stop salute ended the take, or it was spotted without salutes.
    nearest
        Equal to `label`: a recognised gesture is the nearest one.
    confidence, margin
        See `Recognition`.
    recognition
        The complete result of the recogniser.

    """

    start: Seconds
    end: Seconds
    closed: Literal[True]
    label: str
    nearest: str = field(init=False)
    confidence: Share
    margin: float = field(metadata={JSON_TYPE: Margin})
    command: CommandValue
    sha256: Sha256
    revision: Revision
    recognition: Recognition = field(metadata={JSON_TYPE: None})

    def __post_init__(self) -> None:
        object.__setattr__(self, "nearest", self.recognition.nearest)


@dataclass(frozen=True, kw_only=True, eq=False)
class TakeRejected(Event):
    """Something was shown that the robot must not act on.

    Attributes
    ----------
    start, end
        Seconds of the take.
    label
        Always None.
    pair
        The two gestures between which the take lies, nearest first: `reason` asks which one was
        meant. None where it lies between no two, or is not closed.
    nearest, confidence, margin
        Of the nearest gesture, as in `TakeRecognized`; None without a recognition.
    sha256, revision
        Of the language that was active.
    recognition
        The complete result of the recogniser; None where it was not run or raised an error.

    """

    start: Seconds
    end: Seconds
    closed: bool
    """Whether a salute, or the other trigger, ended it."""
    reason: Reason
    label: None = field(init=False, default=None)
    nearest: str | None = field(init=False)
    confidence: Share | None = field(init=False)
    margin: Margin = field(init=False)
    sha256: Sha256
    revision: Revision
    pair: tuple[str, str] | None = None
    """The two gestures between which the take lies, nearest first; null: it lies between no
    two. The diver is asked to show it again."""
    recognition: Recognition | None = field(default=None, metadata={JSON_TYPE: None})

    def __post_init__(self) -> None:
        answer = self.recognition
        for name in ("nearest", "confidence", "margin"):
            object.__setattr__(self, name, None if answer is None else getattr(answer, name))


TakeEvent = TakeRecognized | TakeRejected
"""What came of a take."""


@dataclass(frozen=True)
class PhraseHeard(Event):
    """What came of a gesture, or of a pause, in a language with phrases.

    Attributes
    ----------
    time
        Seconds: when it was known.
    phrase
        Result of the grammar; has a mission where the robot should act. In JSON its keys stand
        beside the others.
    confidence
        Lowest confidence of the message's gestures, in [0, 1]; 0 where none was recognised.
    sha256, revision
        Of the language.

    """

    phrase: PhraseEvent
    confidence: float
    sha256: str
    revision: int
