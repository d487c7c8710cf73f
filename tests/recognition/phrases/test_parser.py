"""Messages gesture by gesture: what may come next, what it means, and when nothing is executed."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.recognition.health.phrase_ambiguity import find_ambiguities
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.parser import PhraseEvent, PhraseParser, interpret_message
from app.recognition.phrases.phrase import Phrase, Slot
from tests.recognition.grammars import LABELS, MISSIONS, NUMBER, grammars, one, sentences

OPEN = Grammar(
    (Phrase("photo", (one("photo"), Slot("times", "number", least=0))),), (NUMBER,), timeout=5
)
"""Without start and end: after "photo" only a pause tells that no number is coming."""


def feed(parser: PhraseParser, *labels: str | None, since: float = 0.0) -> list[PhraseEvent]:
    """Show gestures of a second each, a second apart."""
    return [
        event
        for index, label in enumerate(labels)
        for event in parser.feed(label, since + 2 * index, since + 2 * index + 1)
    ]


def kinds(events: list[PhraseEvent]) -> list[str]:
    return [event.kind for event in events]


def test_a_message_is_understood_gesture_by_gesture() -> None:
    parser = PhraseParser(MISSIONS)
    events = feed(parser, "start", "photo", "three", "end")
    assert kinds(events) == ["continues", "continues", "continues", "complete"]
    assert set(events[0].expected) == {"photo", "picture", "go"}
    assert set(events[1].expected) == {"two", "three", "down", "start", "end"}
    assert set(events[2].expected) == {"down", "start", "end"}
    mission = events[3].mission
    assert mission is not None
    assert mission.spoken == "mission: photo, 3 times"
    (photo,) = mission.phrases
    assert photo.slots == {"times": 3}
    assert photo.command == {"do": "photo", "times": 3, "at": {"depth": None}}
    assert (events[3].start, events[3].end) == (0.0, 7.0)


def test_a_mission_has_several_phrases_and_digits_make_one_number() -> None:
    shown = ["start", "photo", "down", "one", "two", "start", "go", "left", "end"]
    (*_, last) = feed(PhraseParser(MISSIONS), *shown)
    assert last.mission is not None
    assert last.mission.spoken == "mission: photo, at 12 metres; then go left"
    assert [each.command for each in last.mission.phrases] == [
        {"do": "photo", "times": 1, "at": {"depth": 12}},
        "go left",
    ]


def test_a_gesture_that_does_not_follow_drops_the_message_and_says_what_would_have() -> None:
    parser = PhraseParser(MISSIONS)
    events = feed(parser, "start", "go", "three", "left", "end")
    assert kinds(events) == ["continues", "continues", "unexpected", "outside", "outside"]
    assert events[2].expected == ("left", "right")
    assert events[2].text == "three does not follow start, go, left or right does; begin again"
    assert events[2].gestures == ("start", "go")


def test_the_start_gesture_begins_anew_in_the_middle_of_a_message() -> None:
    events = feed(PhraseParser(MISSIONS), "start", "go", "start", "go", "left", "end")
    assert kinds(events)[2:] == ["unexpected", "continues", "continues", "continues", "complete"]


def test_a_rejected_gesture_is_asked_for_again_and_the_sequence_kept() -> None:
    parser = PhraseParser(MISSIONS)
    events = feed(parser, "start", "photo", None, "three", "end")
    assert kinds(events) == ["continues", "continues", "repeat", "continues", "complete"]
    assert events[2].gestures == ("start", "photo")
    assert events[4].mission is not None
    assert events[4].mission.spoken == "mission: photo, 3 times"


def test_cancel_drops_what_was_begun() -> None:
    parser = PhraseParser(MISSIONS)
    events = feed(parser, "start", "photo", "cancel", "end")
    assert kinds(events) == ["continues", "continues", "cancelled", "outside"]
    assert [event.reason for event in events] == [None, None, "cancel_gesture", None]
    assert parser.expected == ("start",)


def test_a_pause_that_is_too_long_drops_the_message() -> None:
    parser = PhraseParser(MISSIONS)
    feed(parser, "start", "photo")
    assert parser.expire(3.0 + MISSIONS.timeout) == ()
    (event,) = parser.expire(3.1 + MISSIONS.timeout)
    assert (event.kind, event.mission) == ("timed_out", None)
    assert kinds(feed(parser, "end", since=20)) == ["outside"]


def test_the_pause_before_a_gesture_counts_and_not_its_own_length() -> None:
    parser = PhraseParser(MISSIONS)
    parser.feed("start", 0.0, 1.0)
    (event,) = parser.feed("photo", 1.0 + MISSIONS.timeout, 60.0)
    assert event.kind == "continues"
    late, end = parser.feed("end", 61.0 + MISSIONS.timeout, 75.0)
    assert (late.kind, end.kind) == ("timed_out", "outside")


def test_without_an_end_a_pause_tells_that_no_more_is_coming() -> None:
    parser = PhraseParser(OPEN)
    assert kinds(feed(parser, "photo")) == ["continues"]
    (event,) = parser.expire(6.5)
    assert event.kind == "complete"
    assert event.mission is not None
    assert event.mission.spoken == "mission: photo"
    assert kinds(feed(parser, "photo", "three")) == ["continues", "complete"]


def test_nothing_is_done_when_the_last_gesture_before_the_pause_was_rejected() -> None:
    parser = PhraseParser(OPEN)
    assert kinds(feed(parser, "photo", None)) == ["continues", "repeat"]
    (event,) = parser.expire(60.0)
    assert (event.kind, event.mission) == ("timed_out", None)


def test_an_event_is_plain_json() -> None:
    (*_, last) = feed(PhraseParser(MISSIONS), "start", "go", "left", "end")
    assert last.to_dict() == {
        "kind": "complete",
        "gestures": ["start", "go", "left", "end"],
        "label": "end",
        "pair": None,
        "expected": ["start"],
        "mission": [
            {"phrase": "go", "slots": {"way": "left"}, "command": "go left", "spoken": "go left"}
        ],
        "reason": None,
        "text": "mission: go left",
        "start": 0.0,
        "end": 7.0,
    }


@pytest.mark.parametrize("phrase", MISSIONS.phrases, ids=lambda phrase: phrase.name)
def test_the_example_of_a_phrase_is_understood_as_that_phrase(phrase: Phrase) -> None:
    (*_, last) = feed(PhraseParser(MISSIONS), *MISSIONS.example(phrase))
    assert last.mission is not None
    assert [each.phrase for each in last.mission.phrases] == [phrase.name]
    (*_, renamed) = feed(
        PhraseParser(MISSIONS.renamed("start", "hello")),
        *MISSIONS.renamed("start", "hello").example(phrase),
    )
    assert renamed.mission == last.mission


@given(grammars(), st.data())
@settings(max_examples=60, deadline=None)
def test_every_message_means_what_it_was_made_to_mean(
    grammar: Grammar, data: st.DataObject
) -> None:
    if find_ambiguities(grammar):
        return
    labels, parse = data.draw(st.sampled_from(list(sentences(grammar))))
    events = feed(PhraseParser(grammar), *labels)
    assert kinds(events) == ["continues"] * (len(labels) - 1) + ["complete"]
    assert events[-1].mission == interpret_message(grammar, parse)
    assert events[-1].gestures == labels


@given(grammars(), st.data())
@settings(max_examples=60, deadline=None)
def test_what_is_expected_is_exactly_what_can_follow(grammar: Grammar, data: st.DataObject) -> None:
    every = [labels for labels, _ in sentences(grammar)]
    labels = data.draw(st.sampled_from(every))
    shown = labels[: data.draw(st.integers(0, len(labels) - 1))]
    parser = PhraseParser(grammar)
    # What may be over may also go on, as long as there is no pause.
    feed(parser, *shown)
    following = {each[len(shown)] for each in every if each[: len(shown)] == shown < each}
    assert set(parser.expected) == following


@given(st.lists(st.sampled_from([*LABELS, "start", "end", None]), max_size=12), grammars())
@settings(max_examples=60, deadline=None)
def test_no_command_ever_contains_a_gesture_that_was_not_recognised(
    shown: list[str | None], grammar: Grammar
) -> None:
    known = {labels for labels, _ in sentences(grammar)}
    parser = PhraseParser(grammar)
    for event in [*feed(parser, *shown), *parser.expire(1000.0)]:
        if event.mission is None:
            continue
        assert event.kind == "complete"
        assert event.gestures in known
        recognised = [label for label in shown if label is not None]
        assert all(label in recognised for label in event.gestures)


def test_two_parsers_of_one_grammar_do_not_hear_each_other() -> None:
    one_diver, other = PhraseParser(MISSIONS), PhraseParser(replace(MISSIONS))
    feed(one_diver, "start", "go")
    assert other.expected == ("start",)


PAIR = ("three", "two")


def test_a_pair_is_asked_for_its_place_and_the_next_showing_decides() -> None:
    parser = PhraseParser(MISSIONS)
    feed(parser, "start", "photo")
    (asked,) = parser.feed(None, 4.0, 5.0, PAIR)
    assert (asked.kind, asked.label, asked.pair, asked.mission) == ("repeat", None, PAIR, None)
    assert asked.gestures == ("start", "photo")
    assert asked.text == "gesture 3: three or two? show it again"
    assert asked.to_dict()["pair"] == ["three", "two"]
    *_, last = feed(parser, "two", "end", since=6.0)
    assert last.mission is not None
    assert last.mission.spoken == "mission: photo, 2 times"
    assert last.pair is None


@pytest.mark.parametrize("between", [(), (None,)])
def test_a_second_pair_is_a_refusal_and_the_message_is_kept(between: tuple[None, ...]) -> None:
    parser = PhraseParser(MISSIONS)
    feed(parser, "start", "photo")
    parser.feed(None, 4.0, 5.0, PAIR)
    feed(parser, *between, since=6.0)
    (refused,) = parser.feed(None, 8.0, 9.0, PAIR)
    assert (refused.kind, refused.pair) == ("repeat", None)
    assert refused.text.startswith("not recognised, show it again")
    (asked,) = parser.feed(None, 10.0, 11.0, PAIR)
    assert asked.pair == PAIR
    *_, last = feed(parser, "three", "end", since=12.0)
    assert last.kind == "complete"


def test_a_pair_at_another_place_is_asked_too() -> None:
    parser = PhraseParser(MISSIONS)
    feed(parser, "start")
    parser.feed(None, 2.0, 3.0, ("photo", "picture"))
    feed(parser, "photo", since=4.0)
    (asked,) = parser.feed(None, 6.0, 7.0, PAIR)
    assert asked.pair == PAIR


def test_a_pair_before_a_message_is_asked_and_begins_none() -> None:
    parser = PhraseParser(MISSIONS)
    (asked,) = parser.feed(None, 0.0, 1.0, ("start", "go"))
    assert (asked.kind, asked.text) == ("outside", "start or go? show it again")
    (refused,) = parser.feed(None, 2.0, 3.0, ("start", "go"))
    assert (refused.kind, refused.pair) == ("outside", None)
    parser.feed(None, 4.0, 5.0, ("start", "go"))
    (asked,) = parser.feed(None, 6.0 + MISSIONS.timeout, 90.0, ("start", "go"))
    assert asked.pair == ("start", "go")


def test_a_pair_does_not_cancel_and_a_pause_after_it_executes_nothing() -> None:
    parser = PhraseParser(MISSIONS)
    feed(parser, "start", "photo")
    (asked,) = parser.feed(None, 4.0, 5.0, ("cancel", "end"))
    assert (asked.kind, asked.mission) == ("repeat", None)
    assert kinds(feed(parser, "end", since=6.0)) == ["complete"]
    open_ended = PhraseParser(OPEN)
    feed(open_ended, "photo")
    assert open_ended.may_end
    open_ended.feed(None, 2.0, 3.0, PAIR)
    assert not open_ended.may_end
    (event,) = open_ended.expire(8.5)
    assert (event.kind, event.mission) == ("timed_out", None)
