"""Ambiguities of a grammar: all are found, each shown by a message."""

from collections import defaultdict
from dataclasses import replace

import pytest
from hypothesis import given, settings

from app.recognition.health.phrase_ambiguity import find_ambiguities
from app.recognition.phrases.automaton import Parse
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.parser import PhraseParser
from app.recognition.phrases.phrase import Phrase, Slot, SlotType
from tests.recognition.grammars import MISSIONS, PHOTO, grammars, one, sentences

DOUBLE = {"same_sequence", "overlap", "run_together"}
NUMBER = SlotType("number", "number", {"two": 2, "three": 3})


def framed(*phrases: Phrase) -> Grammar:
    return Grammar(phrases, (NUMBER,), "start", "end")


def test_missions_like_those_of_caddian_are_not_ambiguous() -> None:
    assert find_ambiguities(MISSIONS) == ()


def test_two_phrases_that_are_shown_alike_are_told_with_the_shortest_message() -> None:
    come, here = Phrase("come", (one("sweep"), one("up", least=0))), Phrase("here", (one("sweep"),))
    found = {each.kind: each for each in find_ambiguities(framed(come, here))}
    assert set(found) == {"same_sequence", "unreachable"}
    assert found["same_sequence"].phrases == ("come", "here")
    assert found["same_sequence"].gestures == ("start", "sweep", "end")
    assert found["unreachable"].phrases == ("here",)  # "come" is still said with "up"
    assert "start, sweep, end" in found["same_sequence"].message


def test_a_slot_whose_values_overlap_with_what_follows_is_told() -> None:
    dive = Phrase("dive", (one("go"), Slot("n", "number", most=2), one("three", least=0)))
    (found,) = find_ambiguities(framed(dive))
    assert (found.kind, found.phrases) == ("overlap", ("dive",))
    assert found.gestures in {
        ("start", "go", "two", "three", "end"),
        ("start", "go", "three", "three", "end"),
    }


def test_an_overlap_that_changes_no_meaning_is_none() -> None:
    either = Phrase("go", (one("go", least=0), one("go"), one("go", least=0)))
    assert find_ambiguities(framed(either)) == ()


def test_without_an_end_a_phrase_that_begins_another_is_told() -> None:
    photo = Phrase("photo", (one("photo"),))
    several = Phrase("several", (one("photo"), Slot("n", "number")))
    (found,) = find_ambiguities(replace(framed(photo, several), end=None))
    assert (found.kind, found.phrases) == ("prefix", ("photo", "several"))
    assert found.gestures == ("start", "photo")
    assert "two or three" in found.message or "three or two" in found.message
    assert "10 s" in found.message
    assert find_ambiguities(framed(photo, several)) == ()


def test_an_optional_part_makes_a_phrase_begin_itself() -> None:
    (found,) = find_ambiguities(replace(MISSIONS, end=None, most_phrases=1, phrases=(PHOTO,)))
    assert (found.kind, found.phrases) == ("prefix", ("photo",))


def test_an_end_gesture_that_a_phrase_uses_does_not_end_it() -> None:
    short, long = Phrase("short", (one("a"),)), Phrase("long", (one("a"), one("end"), one("b")))
    (found,) = find_ambiguities(framed(short, long))
    assert (found.kind, found.gestures) == ("prefix", ("start", "a", "end"))


def test_phrases_that_run_together_are_told() -> None:
    one_by_one = Phrase("a", (one("a", most=2),))
    grammar = Grammar((one_by_one,), end="end", most_phrases=2)
    (found,) = find_ambiguities(grammar)
    assert (found.kind, found.gestures) == ("run_together", ("a", "a", "end"))


def understood(grammar: Grammar) -> dict[tuple[str, ...], set[Parse]]:
    readings = defaultdict(set)
    for labels, reading in sentences(grammar):
        readings[labels].add(reading)
    return readings


@given(grammars())
@settings(max_examples=60, deadline=None)
def test_the_check_finds_exactly_the_ambiguities_there_are(grammar: Grammar) -> None:
    readings = understood(grammar)
    ambiguous = {labels for labels, meant in readings.items() if len(meant) > 1}
    begun = {longer[:length] for longer in readings for length in range(len(longer))}
    unfinished = begun & readings.keys()
    found = find_ambiguities(grammar)
    double = [each for each in found if each.kind in DOUBLE]
    prefix = [each for each in found if each.kind == "prefix"]
    assert {each.gestures for each in double} <= ambiguous
    assert {each.gestures for each in prefix} <= unfinished
    assert bool(found) == bool(ambiguous or unfinished)
    if double and grammar.most_phrases == 1:
        assert min(len(each.gestures) for each in double) == min(map(len, ambiguous))


@given(grammars())
@settings(max_examples=40, deadline=None)
def test_an_unreachable_phrase_has_no_message_of_its_own(grammar: Grammar) -> None:
    single = replace(grammar, most_phrases=1)
    own = defaultdict(list)
    for labels, reading in sentences(single):
        own[reading[0].phrase].append(labels)
    readings = understood(single)
    unreachable = {
        grammar.phrases[index].name
        for index, said in own.items()
        if all(len(readings[labels]) > 1 for labels in said)
    }
    found = find_ambiguities(single)
    assert {each.phrases[0] for each in found if each.kind == "unreachable"} == unreachable


@given(grammars())
@settings(max_examples=40, deadline=None)
def test_a_message_that_is_told_to_be_ambiguous_gives_no_command(grammar: Grammar) -> None:
    for each in find_ambiguities(grammar):
        if each.kind not in DOUBLE:
            continue
        parser = PhraseParser(grammar)
        events = [event for label in each.gestures for event in parser.feed(label, 0.0, 0.0)]
        events += parser.expire(1000.0)
        kinds = [event.kind for event in events]
        assert "complete" not in kinds
        assert "ambiguous" in kinds


@pytest.mark.parametrize("kind", ["same_sequence", "prefix"])
def test_an_ambiguity_is_a_warning_below_the_bar(kind: str) -> None:
    come, here = Phrase("come", (one("sweep"),)), Phrase("here", (one("sweep"), one("up")))
    grammar = replace(
        framed(come, here if kind == "prefix" else replace(come, name="here")), end=None
    )
    findings = [each.finding() for each in find_ambiguities(grammar)]
    assert findings[0].kind == f"phrases_{kind}"
    assert findings[0].error
