"""Where the language has phrases, a command is given for a whole message that was confirmed."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Language
from app.robot.commands.dialogue import (
    CommandDialogue,
    Decision,
    RecognizedGesture,
    RecognizedPhrase,
)
from app.robot.commands.rules import Rules
from osg_ros.commands.table import read_commands
from tests.robot.commands.test_dialogue import RULES, TABLE, gestures, shown
from tests.ros2.workspace import ROOT

PHRASES = replace(TABLE, phrase_labels=frozenset({"circle", "line"}))
"""Photo is a word here, and peak still a gesture of its own."""
KINDS = [
    "continues",
    "complete",
    "ambiguous",
    "cancelled",
    "timed_out",
    "unexpected",
    "repeat",
    "outside",
]


def with_phrases(rules: Rules = RULES) -> CommandDialogue:
    made = CommandDialogue(rules)
    made.set_table(PHRASES)
    return made


def signed(
    stamp: float, kind: str = "complete", mission: str = "photo", **other: Any
) -> RecognizedPhrase:
    phrase = RecognizedPhrase(
        kind=kind,
        mission=mission if kind == "complete" else "",
        text=f"{kind}: {mission}",
        confidence=0.9,
        start=stamp - 1,
        stamp=stamp,
        label="circle",
        language_id="language",
    )
    return replace(phrase, **other)


def answers(
    *arrival: RecognizedGesture | RecognizedPhrase, rules: Rules = RULES
) -> list[str | None]:
    """Return the commands that a dialogue gives when it hears everything at once."""
    made = with_phrases(rules)
    return [decided(made, each, each.stamp).command for each in arrival]


def decided(
    made: CommandDialogue, arrival: RecognizedGesture | RecognizedPhrase, now: float
) -> Decision:
    if isinstance(arrival, RecognizedPhrase):
        return made.decide_phrase(arrival, now)
    return made.decide(arrival, now)


def test_a_word_gives_no_command_alone() -> None:
    assert answers(shown("circle", 1), shown("circle", 2)) == [None, None]
    assert answers(shown("circle", 1), rules=Rules(confirmed=False)) == [None]


def test_a_gesture_outside_the_phrases_and_an_emergency_are_obeyed_as_ever() -> None:
    assert answers(shown("peak", 1), signed(1, "outside", label="peak"), shown("peak", 2)) == [
        None,
        None,
        "follow",
    ]
    assert answers(shown("line", 1)) == ["surface"]


def test_a_message_is_confirmed_by_showing_it_again() -> None:
    made = with_phrases()
    asked = made.decide_phrase(signed(1), 1)
    assert (asked.command, asked.reason) == (
        None,
        "repeat the message to confirm: complete: photo",
    )
    assert made.pending is not None
    made.decide(shown("circle", 5), 5)
    given = made.decide_phrase(signed(5), 5)
    assert (given.command, given.label, given.emergency) == ("photo", "complete: photo", False)
    assert made.pending is None


def test_another_message_takes_the_place_of_the_first() -> None:
    arrivals = [signed(1), signed(2, mission="dive"), signed(3), signed(4)]
    assert answers(*arrivals) == [None, None, None, "photo"]


@pytest.mark.parametrize("kind", ["ambiguous", "cancelled", "timed_out", "unexpected", "outside"])
def test_what_is_dropped_takes_a_message_back(kind: str) -> None:
    assert answers(signed(1), signed(2, kind), signed(3)) == [None, None, None]


@pytest.mark.parametrize("between", ["cross", "peak", "wave"])
def test_a_cancel_or_another_gesture_takes_a_message_back(between: str) -> None:
    assert answers(signed(1), shown(between, 2), signed(3)) == [None, None, None]


def test_a_gesture_that_is_not_understood_changes_nothing_about_a_message() -> None:
    doubts: list[RecognizedGesture | RecognizedPhrase] = [
        shown(None, 2),
        signed(2, "outside", label=None),
        signed(3, "repeat"),
        signed(4, confidence=0.4),
        signed(5, confidence=math.nan),
    ]
    assert answers(signed(1), *doubts, signed(6)) == [None] * 6 + ["photo"]


def test_a_long_message_may_be_finished_when_it_goes_on_in_time() -> None:
    going_on = [signed(second, "continues") for second in (9, 18, 27)]
    assert answers(signed(1), *going_on, signed(36))[-1] == "photo"
    assert answers(signed(1), going_on[1], going_on[2], signed(36))[-1] is None


def test_one_picture_may_end_a_message_and_begin_the_next() -> None:
    arrivals = [signed(1), signed(9, start=2), signed(9, "continues", start=8)]
    assert answers(*arrivals) == [None, "photo", None]


def test_a_message_that_is_played_again_is_ignored() -> None:
    assert answers(signed(1), signed(1)) == [None, None]


def test_a_language_without_phrases_gives_no_mission() -> None:
    made = CommandDialogue(Rules(confirmed=False))
    assert made.decide_phrase(signed(1, language_id=""), 1).command is None
    made.set_table(TABLE)
    assert made.decide_phrase(signed(2), 2).command is None


def test_another_language_forgets_a_message() -> None:
    made = with_phrases()
    made.decide_phrase(signed(1), 1)
    decision = made.set_table(replace(PHRASES, language_id="newer"))
    assert decision is not None
    assert "'complete: photo' is forgotten" in decision.reason
    assert made.pending is None


phrases = st.builds(
    RecognizedPhrase,
    kind=st.sampled_from([*KINDS, "complete", "complete"]),
    mission=st.sampled_from(["", "photo", "dive"]),
    text=st.just("in words"),
    confidence=st.sampled_from([0.4, 0.5, 1.0, math.nan]),
    start=st.integers(0, 60).map(float),
    stamp=st.integers(0, 60).map(float),
    label=st.sampled_from(["circle", None]),
    language_id=st.sampled_from(["language", "language", "language", "older"]),
)
both = st.lists(
    st.tuples(st.one_of(phrases, phrases, gestures), st.sampled_from([-2.0, 0.0, 0.5, 2.0])),
    max_size=30,
)


@given(both)
def test_a_mission_comes_of_a_whole_sure_fresh_message_of_the_language_that_was_asked_for(
    both: list[tuple[RecognizedGesture | RecognizedPhrase, float]],
) -> None:
    made = with_phrases()
    for arrival, late in both:
        before = made.pending
        decision = decided(made, arrival, arrival.stamp + late)
        if isinstance(arrival, RecognizedPhrase) and decision.command is not None:
            assert arrival.kind == "complete"
            assert arrival.confidence >= RULES.least_confidence
            assert abs(late) <= RULES.stale_seconds
            assert arrival.language_id == PHRASES.language_id
            assert before is not None
            assert decision.command == arrival.mission == before.mission
            assert arrival.stamp <= before.deadline
            assert made.pending is None


@given(both)
def test_no_word_gives_a_command_but_an_emergency(
    both: list[tuple[RecognizedGesture | RecognizedPhrase, float]],
) -> None:
    made = with_phrases()
    for arrival, late in both:
        decision = decided(made, arrival, arrival.stamp + late)
        if isinstance(arrival, RecognizedGesture) and arrival.label in PHRASES.phrase_labels:
            assert decision.command is None or decision.emergency


@given(st.lists(st.sampled_from(["", *KINDS]), max_size=6), st.integers(2, 5))
def test_a_confirmed_message_gives_one_command_however_often_it_arrives(
    after: list[str], copies: int
) -> None:
    made = with_phrases()
    arrivals = [signed(1), *[signed(2)] * copies]
    later = [signed(3.0 + place, kind, mission="") for place, kind in enumerate(after)]
    given = [made.decide_phrase(each, each.stamp).command for each in (*arrivals, *later)]
    assert [command for command in given if command] == ["photo"]


def test_the_words_of_a_language_file_are_those_that_its_grammar_uses() -> None:
    path = ROOT / "languages" / "osg-table-2.json"
    grammar = Language.load(path).grammar
    assert grammar is not None
    assert read_commands(str(path)).phrase_labels == {use.label for use in grammar.uses()}


def test_a_language_file_without_phrases_has_no_words() -> None:
    assert read_commands(str(ROOT / "languages" / "osg-table-1.json")).phrase_labels == set()


@pytest.mark.parametrize("grammar", ['{"phrases": [{}]}', "[1]"])
def test_a_grammar_that_cannot_be_read_is_refused(tmp_path: Path, grammar: str) -> None:
    path = tmp_path / "broken.json"
    path.write_text(f'{{"gestures": [], "sha256": "id", "grammar": {grammar}}}', encoding="utf-8")
    with pytest.raises(ValueError, match="not a language file"):
        read_commands(str(path))
