"""JSON messages of the robot: one pydantic model for each event, derived from `app.robot.events`.

`osg-studio robot` writes one JSON object a line. The JSON Schema in `schema/` is theirs.
"""

from __future__ import annotations

import json
import re
from dataclasses import MISSING, fields
from functools import reduce
from inspect import getdoc
from operator import or_
from typing import Annotated, Any, Final, Literal, get_type_hints

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, create_model, model_validator

from app.recognition.phrases.parser import CancelReason, PhraseEventKind
from app.recognition.text.described import DESCRIBED, read_descriptions
from app.robot.events import JSON_TYPE, Event, PhraseHeard, Revision, Seconds, Sha256, Share


class Message(BaseModel):
    """Base of the messages; `event` names the kind of event."""

    model_config = ConfigDict(frozen=True, from_attributes=True)

    time: Seconds
    event: str


class MeaningMessage(BaseModel):
    """One phrase of a message."""

    model_config = ConfigDict(**DESCRIBED, from_attributes=True)

    phrase: str
    """Its name."""
    slots: dict[str, Any]
    """The values shown, by slot."""
    command: str | dict[str, Any] | None
    """What the language's author wants the robot to do, values put in."""
    spoken: str
    """To say back to the diver."""


# Not derived: the event holds the core's `PhraseEvent`, whose keys the JSON puts beside its own.
class PhraseHeardMessage(Message):
    """What came of a gesture, or of a pause, in a language with phrases."""

    model_config = DESCRIBED

    event: Literal["phrase_heard"] = "phrase_heard"
    kind: PhraseEventKind
    """complete: obey the mission. continues: more is needed or may come. repeat: a gesture was not
    recognised, or a pair is asked. ambiguous, cancelled, timed_out, unexpected: the message is
    dropped. outside: none has begun."""
    start: float
    """Seconds, of the message's first gesture."""
    end: float
    """Seconds, of its last gesture."""
    gestures: tuple[str, ...]
    """Of the message so far."""
    label: str | None
    """Of this gesture."""
    pair: tuple[str, str] | None = None
    """The two gestures between which this one lies; null: no two. The diver is asked to show the
    gesture after `gestures` again."""
    expected: tuple[str, ...]
    """What may come next."""
    mission: tuple[MeaningMessage, ...] | None
    """What to do; only when complete."""
    reason: CancelReason | None = None
    """Why it is cancelled; only then. cancel_gesture: the diver's own wish. lost_source (camera or
    diver), end, new_language: the robot has lost the message, and it is not done."""
    text: str
    """In words, for the diver."""
    confidence: Share = 0.0
    """Of the message's least sure gesture; 0: none was recognised."""
    sha256: Sha256
    revision: Revision

    @model_validator(mode="before")
    @classmethod
    def _flatten(cls, event: Any) -> Any:
        if not isinstance(event, PhraseHeard):
            return event
        known = ("time", "confidence", "sha256", "revision")
        return event.phrase.to_dict() | {name: getattr(event, name) for name in known}


def _derive_message(event: type[Event]) -> type[Message]:
    """Create the message model of an event from the dataclass's annotations and docstring."""
    annotations, described = get_type_hints(event, include_extras=True), read_descriptions(event)
    name = re.sub(r"(?<!^)(?=[A-Z])", "_", event.__name__).lower()
    keys: dict[str, Any] = {"event": (Literal[name], name)}
    for each in fields(event):
        json_type = each.metadata.get(JSON_TYPE, annotations[each.name])
        if each.name in described:
            json_type = Annotated[json_type, Field(description=described[each.name])]
        if json_type is not None and each.name != "time":
            keys[each.name] = (json_type, ... if each.default is MISSING else each.default)
    return create_model(
        f"{event.__name__}Message",
        __base__=Message,
        __module__=__name__,
        __doc__=(getdoc(event) or "").partition("\n\n")[0],
        **keys,
    )


_MODELS: Final[dict[type[Event], type[Message]]] = {
    event: PhraseHeardMessage if event is PhraseHeard else _derive_message(event)
    for event in Event.__subclasses__()
}

_ANY_MESSAGE: Any = Annotated[reduce(or_, _MODELS.values()), Field(discriminator="event")]

MESSAGES: TypeAdapter[Message] = TypeAdapter(_ANY_MESSAGE)
"""Reads a line back: ``MESSAGES.validate_json(line)``."""


def to_message(event: Event) -> Message:
    """Convert an event to a model of plain JSON types."""
    return _MODELS[type(event)].model_validate(event)


def format_line(event: Event) -> str:
    """Format an event as one line of JSON in ASCII, ``event`` first, without a line break."""
    content = to_message(event).model_dump(mode="json")
    return json.dumps({"event": content.pop("event")} | content, allow_nan=False)
