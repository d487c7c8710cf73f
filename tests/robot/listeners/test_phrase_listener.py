"""Phrases on the robot: what is recognised makes messages, and nothing else is obeyed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import OneOf, Phrase, Slot, SlotType
from app.recognition.recording.segmentation import TakeState
from app.robot import (
    ActiveLanguage,
    Event,
    Listener,
    PhraseHeard,
    PhraseListener,
    TakeRecognized,
    TakeRejected,
)
from tests.api.recordings import recording_of
from tests.robot.languages import heard, language_of, moments_of, spoken
from tests.robot.listeners.test_salute_listener import cut, moved

PHOTO = Phrase(
    "photo",
    (OneOf(("circle",)), Slot("times", "number", least=0)),
    {"times": "{times}"},
    "photo[, {times} times]",
)
NUMBER = SlotType("number", "number", {"line": 1})
OPEN = Grammar((PHOTO,), (NUMBER,), timeout=5)
CLOSED = Grammar((Phrase("photo", (OneOf(("circle",)),)),), end="line", timeout=5)


def language(grammar: Grammar) -> ActiveLanguage:
    made = replace(language_of("circle", "line"), grammar=grammar)
    return ActiveLanguage.from_json(made.to_json())


def phrases(events: list[Event]) -> list[tuple[str, str | None]]:
    told = [event.phrase for event in events if isinstance(event, PhraseHeard)]
    return [(each.kind, None if each.mission is None else each.mission.spoken) for each in told]


def quiet(listener: PhraseListener, since: float, until: float) -> list[Event]:
    """Show nothing for a while."""
    *_, (last, _) = moments_of(recording_of())
    return [
        event
        for second in range(round(since), round(until))
        for event in listener.feed(moved(last, second - float(last.time[0])), 0.0)
    ]


def test_a_message_is_heard_right_after_the_gesture_that_closes_it() -> None:
    told = heard(PhraseListener(Listener(language(CLOSED))), recording_of("circle", "line"))
    assert phrases(told) == [("continues", None), ("complete", "mission: photo")]
    takes = [event for event in told if isinstance(event, TakeRecognized)]
    last = next(event for event in reversed(told) if isinstance(event, PhraseHeard))
    assert (last.phrase.start, last.phrase.end) == (takes[0].start, takes[1].end)
    assert last.time == takes[1].time
    assert last.confidence == min(take.confidence for take in takes)
    assert told.index(last) == told.index(takes[1]) + 1


def test_a_language_without_phrases_is_heard_as_before() -> None:
    recording = recording_of("circle")
    told = heard(PhraseListener(Listener(spoken("circle", "line"))), recording)
    assert [type(event) for event in told] == [
        type(event) for event in heard(Listener(spoken("circle", "line")), recording)
    ]
    assert phrases(told) == []


def test_a_rejected_take_is_asked_for_again_and_gives_no_command() -> None:
    grammar = replace(CLOSED, end="circle")
    made = ActiveLanguage.from_json(replace(language_of("circle"), grammar=grammar).to_json())
    told = heard(PhraseListener(Listener(made)), recording_of("circle", "line"))
    assert any(isinstance(event, TakeRejected) for event in told)
    assert phrases(told) == [("continues", None), ("repeat", None)]


def test_a_pause_ends_a_message_that_needs_no_end() -> None:
    listener = PhraseListener(Listener(language(OPEN)))
    recording = recording_of("circle")
    assert phrases(heard(listener, recording)) == [("continues", None)]
    told = quiet(listener, recording.poses.duration + 1, recording.poses.duration + 12)
    assert phrases(told) == [("complete", "mission: photo")]


def test_a_pause_is_not_too_long_while_a_take_goes_on() -> None:
    listener = PhraseListener(Listener(language(replace(CLOSED, timeout=3))))
    recording = recording_of("circle", "line")
    assert phrases(heard(listener, recording)) == [
        ("continues", None),
        ("complete", "mission: photo"),
    ]


def test_a_gesture_told_late_still_belongs_to_the_message() -> None:
    prompt, late = (PhraseListener(Listener(language(OPEN)), lag) for lag in (0.0, 20.0))
    recording = recording_of("circle")
    for listener, kinds in ((prompt, ["complete"]), (late, [])):
        heard(listener, recording)
        told = quiet(listener, recording.poses.duration + 1, recording.poses.duration + 12)
        assert [kind for kind, _ in phrases(told)] == kinds


@pytest.mark.parametrize("how", ["abandon", "finish", "speak"])
def test_a_message_does_not_outlive_its_source_stream_or_language(how: str) -> None:
    listener = PhraseListener(Listener(language(OPEN)))
    recording = recording_of("circle")
    heard(listener, recording)
    now = recording.poses.duration + 0.5
    told: list[Event] = []
    if how == "abandon":
        told += listener.abandon(now, "the source was lost")
    elif how == "finish":
        told += listener.finish()
    else:
        listener.set_language(language(CLOSED))
    told += quiet(listener, now + 1, now + 12)
    assert phrases(told) == [("cancelled", None)]


def test_a_stream_that_begins_anew_cancels_a_message() -> None:
    listener = PhraseListener(Listener(language(CLOSED)))
    heard(listener, recording_of("circle"))
    told = heard(listener, recording_of("line"))
    assert phrases(told) == [("cancelled", None), ("outside", None)]


def test_the_state_and_the_language_are_those_of_the_listener_inside() -> None:
    listener = PhraseListener(Listener(language(OPEN)))
    heard(listener, cut(recording_of("circle"), 1.5))
    assert listener.state is TakeState.recording
    assert listener.language.name == "pool"
