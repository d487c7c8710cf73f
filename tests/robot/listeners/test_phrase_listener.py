"""Phrases on the robot: recognised gestures make messages, and only these give commands."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.recognition import Gesture, Language
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import OneOf, Phrase, Slot, SlotType
from app.recognition.recording.segmentation import TakeState
from app.robot import (
    ActiveLanguage,
    Event,
    PhraseHeard,
    PhraseListener,
    TakeRecognized,
    TakeRejected,
    TriggerListener,
)
from app.robot.commands.replies import Reply, find_phrase_reply
from tests.api.recordings import recording_of
from tests.recognition.held_takes import FIST, FLAT, between_salutes, follow, hold
from tests.robot.languages import ambiguous, language_of, moments_of, run_listener, spoken
from tests.robot.listeners.test_trigger_listener import cut, moved

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
    emitted = [event.phrase for event in events if isinstance(event, PhraseHeard)]
    return [(each.kind, None if each.mission is None else each.mission.spoken) for each in emitted]


def quiet(listener: PhraseListener, since: float, until: float) -> list[Event]:
    """Show nothing for a while."""
    *_, (last, _) = moments_of(recording_of())
    return [
        event
        for second in range(round(since), round(until))
        for event in listener.feed(moved(last, second - float(last.time[0])), 0.0)
    ]


def test_a_message_is_emitted_right_after_the_gesture_that_closes_it() -> None:
    emitted = run_listener(
        PhraseListener(TriggerListener(language(CLOSED))), recording_of("circle", "line")
    )
    assert phrases(emitted) == [("continues", None), ("complete", "mission: photo")]
    takes = [event for event in emitted if isinstance(event, TakeRecognized)]
    last = next(event for event in reversed(emitted) if isinstance(event, PhraseHeard))
    assert (last.phrase.start, last.phrase.end) == (takes[0].start, takes[1].end)
    assert last.time == takes[1].time
    assert last.confidence == min(take.confidence for take in takes)
    assert emitted.index(last) == emitted.index(takes[1]) + 1


def test_a_language_without_phrases_gives_the_same_events() -> None:
    recording = recording_of("circle")
    emitted = run_listener(PhraseListener(TriggerListener(spoken("circle", "line"))), recording)
    assert [type(event) for event in emitted] == [
        type(event) for event in run_listener(TriggerListener(spoken("circle", "line")), recording)
    ]
    assert phrases(emitted) == []


def test_a_rejected_take_is_asked_for_again_and_gives_no_command() -> None:
    grammar = replace(CLOSED, end="circle")
    made = ActiveLanguage.from_json(replace(language_of("circle"), grammar=grammar).to_json())
    emitted = run_listener(PhraseListener(TriggerListener(made)), recording_of("circle", "line"))
    assert any(isinstance(event, TakeRejected) for event in emitted)
    assert phrases(emitted) == [("continues", None), ("repeat", None)]


def test_a_pair_is_asked_for_its_place_and_executes_nothing() -> None:
    active = ambiguous(replace(CLOSED, end="line"))
    emitted = run_listener(PhraseListener(TriggerListener(active)), recording_of("circle", "line"))
    (take, _) = [event for event in emitted if isinstance(event, TakeRejected | TakeRecognized)]
    assert isinstance(take, TakeRejected)
    assert set(take.pair or ()) == {"circle", "ring"}
    (asked, _) = [event.phrase for event in emitted if isinstance(event, PhraseHeard)]
    assert (asked.kind, asked.pair, asked.text) == ("outside", take.pair, take.reason)
    assert phrases(emitted) == [("outside", None), ("outside", None)]


def test_a_pause_ends_a_message_that_needs_no_end() -> None:
    listener = PhraseListener(TriggerListener(language(OPEN)))
    recording = recording_of("circle")
    assert phrases(run_listener(listener, recording)) == [("continues", None)]
    emitted = quiet(listener, recording.poses.duration + 1, recording.poses.duration + 12)
    assert phrases(emitted) == [("complete", "mission: photo")]


def test_a_pause_is_not_too_long_while_a_take_goes_on() -> None:
    listener = PhraseListener(TriggerListener(language(replace(CLOSED, timeout=3))))
    recording = recording_of("circle", "line")
    assert phrases(run_listener(listener, recording)) == [
        ("continues", None),
        ("complete", "mission: photo"),
    ]


def test_a_gesture_emitted_late_still_belongs_to_the_message() -> None:
    prompt, late = (PhraseListener(TriggerListener(language(OPEN)), lag) for lag in (0.0, 20.0))
    recording = recording_of("circle")
    for listener, kinds in ((prompt, ["complete"]), (late, [])):
        run_listener(listener, recording)
        emitted = quiet(listener, recording.poses.duration + 1, recording.poses.duration + 12)
        assert [kind for kind, _ in phrases(emitted)] == kinds


@pytest.mark.parametrize(
    ("how", "reason"),
    [("abandon", "lost_source"), ("finish", "end"), ("speak", "new_language")],
)
def test_a_message_does_not_outlive_its_source_stream_or_language(how: str, reason: str) -> None:
    listener = PhraseListener(TriggerListener(language(OPEN)))
    recording = recording_of("circle")
    run_listener(listener, recording)
    now = recording.poses.duration + 0.5
    emitted: list[Event] = []
    if how == "abandon":
        emitted += listener.abandon(now, "the source was lost")
    elif how == "finish":
        emitted += listener.finish()
    else:
        listener.set_language(language(CLOSED))
    emitted += quiet(listener, now + 1, now + 12)
    assert phrases(emitted) == [("cancelled", None)]
    (heard,) = [event.phrase for event in emitted if isinstance(event, PhraseHeard)]
    assert (heard.reason, heard.label) == (reason, None)
    assert heard.text.startswith("circle: ")
    assert find_phrase_reply(heard.kind, heard.label, heard.pair) is Reply.refused


def test_a_stream_that_begins_anew_cancels_a_message() -> None:
    listener = PhraseListener(TriggerListener(language(CLOSED)))
    run_listener(listener, recording_of("circle"))
    emitted = run_listener(listener, recording_of("line"))
    assert phrases(emitted) == [("cancelled", None), ("outside", None)]


def test_the_state_and_the_language_are_those_of_the_listener_inside() -> None:
    listener = PhraseListener(TriggerListener(language(OPEN)))
    run_listener(listener, cut(recording_of("circle"), 1.5))
    assert listener.state is TakeState.recording
    assert listener.language.name == "pool"


def test_a_sequence_of_two_hand_shapes_is_one_gesture_of_a_message() -> None:
    shown = {
        "start": follow(hold(FLAT), hold(FIST)),
        "flat": hold(FLAT),
        "end": follow(hold(FIST), hold(FLAT)),
    }
    gestures = [Gesture.from_demonstration(label, take) for label, take in shown.items()]
    grammar = Grammar((Phrase("dive", (OneOf(("flat",)),)),), start="start", end="end", timeout=9)
    speaking = ActiveLanguage.from_json(Language("pool", gestures, grammar=grammar).to_json())
    heard = run_listener(
        PhraseListener(TriggerListener(speaking)), between_salutes(*shown.values())
    )
    assert [each.label for each in heard if isinstance(each, TakeRecognized)] == [*shown]
    assert phrases(heard)[-1] == ("complete", "mission: dive")
