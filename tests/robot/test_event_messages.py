"""Every event becomes one line of JSON that obeys the published schema."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import datetime, timezone
from typing import Any

import jsonschema
import pytest

from app.recognition.phrases.parser import PhraseParser
from app.recognition.recording.segmentation import TakeState
from app.robot import (
    AnswerGiven,
    Event,
    FrameRateChanged,
    FramesDropped,
    Heartbeat,
    LanguageChanged,
    LanguageRefused,
    OutputFailed,
    PhraseHeard,
    RecognitionReady,
    SourceEnded,
    SourceLost,
    SourceOpened,
    SourceRestored,
    SourceWarned,
    StateChanged,
    TakeRecognized,
    TakeRejected,
    TriggerListener,
    VehicleReported,
)
from app.robot.commands.replies import Reply
from app.robot.event_messages import (
    MESSAGES,
    format_line,
    to_message,
)
from tests.api.recordings import recording_of
from tests.published_schemas import ROBOT_EVENT
from tests.recognition.grammars import MISSIONS
from tests.robot.languages import run_listener, spoken

SCHEMA = ROBOT_EVENT.content
SEAL = "0123456789abcdef" * 4


def recognized(command: str | dict[str, Any] | None = None) -> TakeRecognized:
    emitted = run_listener(TriggerListener(spoken("circle", "line")), recording_of("line"))
    (event,) = [event for event in emitted if isinstance(event, TakeRecognized)]
    return replace(event, command=command)


def rejected() -> TakeRejected:
    emitted = run_listener(TriggerListener(spoken("circle")), recording_of("line"))
    (event,) = [event for event in emitted if isinstance(event, TakeRejected)]
    return event


def phrases(*shown: str) -> list[Event]:
    parser = PhraseParser(MISSIONS)
    events = [event for label in shown for event in parser.feed(label, 1.0, 2.0)]
    return [PhraseHeard(3.0, event, 0.9, SEAL, 3) for event in events]


def asked() -> list[Event]:
    pair = ("three", "two")
    parser = PhraseParser(MISSIONS)
    parser.feed("start", 1.0, 2.0)
    (phrase,) = parser.feed(None, 3.0, 4.0, pair)
    return [replace(rejected(), pair=pair), PhraseHeard(3.0, phrase, 0.9, SEAL, 3)]


EVENTS: list[Event] = [
    *asked(),
    *phrases("start", "photo", "three", "end"),
    SourceOpened(0.0, "reef", True, (640, 480), datetime(2026, 11, 21, 13, 0, tzinfo=timezone.utc)),
    SourceOpened(0.0, "dive.mp4", False, (640, 480), None),
    SourceWarned(2.0, "the clip is damaged"),
    SourceLost(2.0, "unplugged"),
    SourceRestored(4.0, 2.0, 3),
    SourceEnded(9.0, 120, 4, True),
    FramesDropped(10.0, 10.0, 3, 200),
    Heartbeat(5.0, 100, 3, lost=False),
    RecognitionReady(8.0),
    FrameRateChanged(13.0, 2.0, sufficient=False),
    FrameRateChanged(18.0, 4.0, sufficient=True),
    OutputFailed(19.0, "stdout", "No space left on device"),
    VehicleReported(20.0, "done: hold"),
    AnswerGiven(20.0, Reply.repeat, 2, "repeat 'circle' to confirm: hold"),
    StateChanged(1.0, TakeState.recording),
    LanguageChanged(0.0, "Rïff", SEAL, 3, ("circle", "⟲"), "full", "as the profile does"),
    LanguageRefused(5.0, "/format: not a language file", SEAL, 3),
    recognized(),
    recognized("Come here"),
    recognized({"turn": 90}),
    rejected(),
    replace(rejected(), recognition=None),
]


def test_every_kind_of_event_is_tried() -> None:
    assert {type(event) for event in EVENTS} == set(Event.__subclasses__())


@pytest.mark.parametrize("event", EVENTS, ids=lambda event: type(event).__name__)
def test_a_line_obeys_the_schema_and_can_be_read_back(event: Event) -> None:
    line = format_line(event)
    assert line.isascii()
    assert "\n" not in line
    content = json.loads(line)
    assert next(iter(content)) == "event"
    jsonschema.Draft202012Validator(SCHEMA).validate(content)
    assert MESSAGES.validate_json(line) == to_message(event)


def test_a_recognition_tells_what_was_said_when_and_in_which_language() -> None:
    event = recognized("Come here")
    content = json.loads(format_line(event))
    assert content.pop("margin") == event.recognition.margin
    assert content == {
        "event": "take_recognized",
        "time": event.time,
        "start": event.start,
        "end": event.end,
        "closed": True,
        "label": "line",
        "nearest": "line",
        "confidence": event.confidence,
        "command": "Come here",
        "sha256": event.sha256,
        "revision": 1,
    }


def test_a_pair_is_named_and_lines_written_before_have_none() -> None:
    for event in asked():
        content = json.loads(format_line(event))
        assert (content["label"], content["pair"]) == (None, ["three", "two"])
        del content["pair"]
        jsonschema.Draft202012Validator(SCHEMA).validate(content)
        assert MESSAGES.validate_python(content).model_dump()["pair"] is None


def test_a_margin_to_no_other_gesture_is_null() -> None:
    assert json.loads(format_line(rejected()))["margin"] is None
