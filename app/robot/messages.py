"""Events as JSON, one object a line: the models of what `osg-studio robot` writes.

The JSON Schema published in `schema/` is generated from here.
"""

from __future__ import annotations

import json
import math
from datetime import datetime
from importlib import resources
from typing import Annotated, Any, Final, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    TypeAdapter,
    model_validator,
)

from app.recognition.phrases.parser import PhraseEventKind
from app.recognition.recording.segmentation import TakeState
from app.robot.events import (
    Event,
    FramesDropped,
    LanguageChanged,
    LanguageRefused,
    PhraseHeard,
    SourceEnded,
    SourceLost,
    SourceOpened,
    SourceRestored,
    SourceWarned,
    StateChanged,
    TakeRecognized,
    TakeRejected,
)

VERSION: Final = 1
"""Of the lines; raised when a reader of today could misunderstand one. New keys and new events may
come without."""

SCHEMA_ID = f"urn:osg-studio:robot-event:{VERSION}"
SCHEMA_FILE = f"robot-event-{VERSION}.schema.json"


def _finite(value: float | None) -> float | None:
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
    BeforeValidator(_finite),
    Field(
        description="How much nearer the nearest gesture is than every other, in the unit of the "
        "recogniser's scores; null where no other can be compared."
    ),
]


class _Message(BaseModel):
    model_config = ConfigDict(frozen=True, from_attributes=True)

    time: Seconds


class SourceOpenedMessage(_Message):
    """Frames are about to be looked at; the first line."""

    event: Literal["source_opened"] = "source_opened"
    source: Annotated[str, Field(description="Its name, without passwords.")]
    live: Annotated[bool, Field(description="Whether frames may be dropped.")]
    frame_size: Annotated[tuple[int, int], Field(description="Width and height in pixels.")]
    began: Annotated[
        datetime | None,
        Field(description="When the source's clock was 0, in UTC; null for a recording."),
    ]


class SourceWarnedMessage(_Message):
    """Something is wrong with the source that does not stop it."""

    event: Literal["source_warned"] = "source_warned"
    reason: Reason


class SourceLostMessage(_Message):
    """A camera gives no frames any more and is being opened again; a take begun is rejected."""

    event: Literal["source_lost"] = "source_lost"
    reason: Reason


class SourceRestoredMessage(_Message):
    """A lost camera gives frames again."""

    event: Literal["source_restored"] = "source_restored"
    missing: Annotated[float, Field(description="Seconds without a frame.")]
    attempts: Annotated[int, Field(ge=1, description="How often opening was tried.")]


class SourceEndedMessage(_Message):
    """The recording is over, or the robot was stopped; the last line."""

    event: Literal["source_ended"] = "source_ended"
    frames: Annotated[Count, Field(description="Looked at.")]
    dropped: Annotated[Count, Field(description="Left out because newer ones had come.")]
    stopped: Annotated[bool, Field(description="By a signal, before the source was over.")]


class FramesDroppedMessage(_Message):
    """The camera is faster than this machine."""

    event: Literal["frames_dropped"] = "frames_dropped"
    seconds: Annotated[float, Field(description="Since when is counted.")]
    dropped: Count
    frames: Annotated[Count, Field(description="Looked at in this time.")]


class StateChangedMessage(_Message):
    """Another state of the salutes."""

    event: Literal["state_changed"] = "state_changed"
    state: Annotated[
        TakeState,
        Field(
            description="idle: a salute, or without salutes a gesture, is awaited; recording: a "
            "take goes on; done: the salute that ended it is still held."
        ),
    ]


class LanguageChangedMessage(_Message):
    """From now on takes are recognised by this language; the second line, and after a reload."""

    event: Literal["language_changed"] = "language_changed"
    name: str
    sha256: Sha256
    revision: Revision
    gestures: Annotated[tuple[str, ...], Field(description="The labels.")]
    profile: Annotated[str, Field(description="The voters that recognise it.")]
    tuning: Annotated[str, Field(description='What differs from that, in words: "recognised ...".')]


class LanguageRefusedMessage(_Message):
    """A new language file cannot be used; the language told here is kept."""

    event: Literal["language_refused"] = "language_refused"
    reason: Reason
    sha256: Sha256
    revision: Revision


class TakeRecognizedMessage(_Message):
    """A gesture was shown."""

    event: Literal["take_recognized"] = "take_recognized"
    start: Seconds
    end: Seconds
    closed: Literal[True]
    label: str
    nearest: str
    confidence: Share
    margin: Margin
    command: Annotated[
        str | dict[str, Any] | None,
        Field(description="What the language's author wants the robot to do."),
    ]
    sha256: Sha256
    revision: Revision


class TakeRejectedMessage(_Message):
    """Something was shown that the robot must not act on."""

    event: Literal["take_rejected"] = "take_rejected"
    start: Seconds
    end: Seconds
    closed: Annotated[bool, Field(description="Whether a salute ended it.")]
    reason: Reason
    label: None = None
    nearest: str | None
    confidence: Share | None
    margin: Margin
    sha256: Sha256
    revision: Revision


class MeaningMessage(BaseModel):
    """One phrase of a message."""

    model_config = ConfigDict(frozen=True, from_attributes=True)

    phrase: Annotated[str, Field(description="Its name.")]
    slots: Annotated[dict[str, Any], Field(description="The values shown, by slot.")]
    command: Annotated[
        str | dict[str, Any] | None,
        Field(description="What the language's author wants the robot to do, values put in."),
    ]
    spoken: Annotated[str, Field(description="To say back to the diver.")]


class PhraseHeardMessage(_Message):
    """What came of a gesture, or of a pause, in a language with phrases."""

    event: Literal["phrase_heard"] = "phrase_heard"
    kind: Annotated[
        PhraseEventKind,
        Field(
            description="complete: obey the mission. continues: more is needed or may come. "
            "repeat: a gesture was not recognised. ambiguous, cancelled, timed_out, unexpected: "
            "the message is dropped. outside: none has begun."
        ),
    ]
    start: Annotated[float, Field(description="Seconds, of the message's first gesture.")]
    end: Annotated[float, Field(description="Seconds, of its last gesture.")]
    gestures: Annotated[tuple[str, ...], Field(description="Of the message so far.")]
    label: Annotated[str | None, Field(description="Of this gesture.")]
    expected: Annotated[tuple[str, ...], Field(description="What may come next.")]
    mission: Annotated[
        tuple[MeaningMessage, ...] | None, Field(description="What to do; only when complete.")
    ]
    text: Annotated[str, Field(description="In words, for the diver.")]
    confidence: Annotated[
        Share, Field(description="Of the message's least sure gesture; 0: none was recognised.")
    ] = 0.0
    sha256: Sha256
    revision: Revision

    @model_validator(mode="before")
    @classmethod
    def _flattened(cls, event: Any) -> Any:
        if not isinstance(event, PhraseHeard):
            return event
        known = ("time", "confidence", "sha256", "revision")
        return event.phrase.to_dict() | {name: getattr(event, name) for name in known}


Message = (
    SourceOpenedMessage
    | SourceWarnedMessage
    | SourceLostMessage
    | SourceRestoredMessage
    | SourceEndedMessage
    | FramesDroppedMessage
    | StateChangedMessage
    | LanguageChangedMessage
    | LanguageRefusedMessage
    | TakeRecognizedMessage
    | TakeRejectedMessage
    | PhraseHeardMessage
)

MESSAGES: TypeAdapter[Message] = TypeAdapter(Annotated[Message, Field(discriminator="event")])
"""Reads a line back: ``MESSAGES.validate_json(line)``."""

_OF_EVENT: dict[type[Event], type[Message]] = {
    SourceOpened: SourceOpenedMessage,
    SourceWarned: SourceWarnedMessage,
    SourceLost: SourceLostMessage,
    SourceRestored: SourceRestoredMessage,
    SourceEnded: SourceEndedMessage,
    FramesDropped: FramesDroppedMessage,
    StateChanged: StateChangedMessage,
    LanguageChanged: LanguageChangedMessage,
    LanguageRefused: LanguageRefusedMessage,
    TakeRecognized: TakeRecognizedMessage,
    TakeRejected: TakeRejectedMessage,
    PhraseHeard: PhraseHeardMessage,
}


def message_of(event: Event) -> Message:
    """Return an event as a model of plain JSON types."""
    return _OF_EVENT[type(event)].model_validate(event)


def line_of(event: Event) -> str:
    """Return an event as one line of JSON in ASCII, ``event`` first, without the line's end."""
    content = message_of(event).model_dump(mode="json")
    return json.dumps({"event": content.pop("event")} | content, allow_nan=False)


def generated_schema() -> str:
    """Return the JSON Schema 2020-12 of a line as text, made from the models."""
    schema = MESSAGES.json_schema(mode="serialization")
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": SCHEMA_ID}
    return json.dumps(head | schema, indent=2) + "\n"


def published_schema() -> str:
    """Return the JSON Schema as it is checked in and shipped."""
    return (resources.files("app.robot") / "schema" / SCHEMA_FILE).read_text("utf-8")
