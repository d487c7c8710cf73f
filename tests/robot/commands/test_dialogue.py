"""A command is given for a confirmed gesture or an emergency, and for nothing else."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.robot.commands.dialogue import (
    CommandDialogue,
    CommandTable,
    Decision,
    RecognizedGesture,
    Rules,
)

TABLE = CommandTable("language", {"circle": "photo", "line": "surface", "peak": "follow"})
RULES = Rules(
    confirm_seconds=10.0,
    stale_seconds=1.0,
    least_confidence=0.5,
    cancel=frozenset({"cross"}),
    emergency=frozenset({"line"}),
    emergency_seconds=10.0,
)
LABELS = [*TABLE.commands, "cross", "wave", None]


def dialogue(rules: Rules = RULES) -> CommandDialogue:
    made = CommandDialogue(rules)
    made.set_table(TABLE)
    return made


def shown(
    label: str | None, stamp: float, confidence: float = 0.9, language: str = "language"
) -> RecognizedGesture:
    return RecognizedGesture(label, confidence, stamp, language)


def commands_of(*gestures: RecognizedGesture, rules: Rules = RULES) -> list[str | None]:
    made = dialogue(rules)
    return [made.decide(gesture, gesture.stamp).command for gesture in gestures]


def test_a_gesture_is_confirmed_by_showing_it_again() -> None:
    assert commands_of(shown("circle", 1), shown("circle", 6)) == [None, "photo"]


def test_a_third_showing_begins_anew() -> None:
    three = [shown("circle", second) for second in (1, 2, 3)]
    assert commands_of(*three) == [None, "photo", None]


def test_a_repetition_that_comes_too_late_is_the_first_of_a_new_pair() -> None:
    assert commands_of(shown("circle", 1), shown("circle", 12), shown("circle", 13)) == [
        None,
        None,
        "photo",
    ]


def test_another_gesture_takes_the_place_of_the_first() -> None:
    gestures = [shown("circle", 1), shown("peak", 2), shown("circle", 3), shown("circle", 4)]
    assert commands_of(*gestures) == [None, None, None, "photo"]


def test_a_rejected_take_in_between_changes_nothing() -> None:
    gestures = [shown("circle", 1), shown(None, 2), shown("circle", 3)]
    assert commands_of(*gestures) == [None, None, "photo"]


@pytest.mark.parametrize("between", ["cross", "wave"])
def test_a_cancel_or_a_gesture_without_command_takes_it_back(between: str) -> None:
    gestures = [shown("circle", 1), shown(between, 2), shown("circle", 3)]
    assert commands_of(*gestures) == [None, None, None]


def test_an_emergency_is_given_at_once_and_takes_back_the_rest() -> None:
    made = dialogue()
    made.decide(shown("circle", 1), 1)
    decision = made.decide(shown("line", 2), 2)
    assert (decision.command, decision.emergency) == ("surface", True)
    assert made.pending is None


def test_without_confirmation_a_gesture_is_enough() -> None:
    assert commands_of(shown("circle", 1), rules=Rules(confirmed=False)) == ["photo"]


@pytest.mark.parametrize("now", [4.5, 1.5, math.nan])
def test_a_stale_gesture_or_one_of_another_clock_is_ignored(now: float) -> None:
    made = dialogue()
    decision = made.decide(shown("peak", 3), now)
    assert decision.command is None
    assert decision.reason.startswith("ignored")


def test_a_gesture_that_is_played_again_is_ignored() -> None:
    assert commands_of(shown("circle", 1), shown("circle", 1)) == [None, None]


def test_a_gesture_of_another_language_is_ignored() -> None:
    rules = Rules(confirmed=False)
    assert commands_of(shown("circle", 1, language="older"), rules=rules) == [None]


@pytest.mark.parametrize("now", [4.1, 3600.0, -3600.0])
@pytest.mark.parametrize("language", ["language", "older"])
def test_a_cancel_passes_however_old_it_is(now: float, language: str) -> None:
    made = dialogue()
    made.decide(shown("circle", now), now)
    decision = made.decide(shown("cross", 0, language=language), now)
    assert "'circle' is cancelled" in decision.reason
    assert decision.cancels
    assert made.pending is None


@pytest.mark.parametrize(
    ("age", "emergency"),
    [
        (9.9, {}),
        (10.1, {"refused": "stale"}),
        (24 * 3600.0, {"refused": "stale"}),
        (-3600.0, {"refused": "another clock"}),
        (0.0, {"language": "older", "refused": "of another language"}),
        (0.0, {"stamp": math.nan, "refused": "has no stamp"}),
        (0.0, {"confidence": 0.0, "refused": "not understood"}),
        (0.0, {"confidence": 0.19, "refused": "not understood"}),
        (0.0, {"confidence": 0.2}),
    ],
)
def test_an_emergency_is_recent_sure_and_of_the_language(
    age: float, emergency: dict[str, Any]
) -> None:
    refused = emergency.pop("refused", None)
    stamp = emergency.pop("stamp", 5000.0)
    made = dialogue(Rules(emergency=frozenset({"line"})))
    decision = made.decide(shown("line", stamp, **emergency), 5000.0 + age)
    assert decision.command == (None if refused else "surface")
    assert (refused or "emergency") in decision.reason
    assert made.decide(shown("circle", 9000), 9000).reason.startswith("repeat")


def test_a_clock_that_is_set_back_changes_no_order() -> None:
    made = dialogue()
    hour = 3600.0
    made.decide(shown("circle", hour), hour)
    made.check_deadline(hour + 2)
    # Two seconds later by other clocks, an hour earlier by this one.
    assert made.decide(shown("circle", 5), 5).command == "photo"
    made.decide(shown("peak", 10), 10)
    assert made.check_deadline(10 + RULES.confirm_seconds + RULES.stale_seconds + 1) is not None


def test_a_stamp_from_the_future_keeps_nothing_back() -> None:
    made = dialogue()
    made.decide(shown("circle", 1.9), 1.0)
    assert made.decide(shown("circle", 1.5), 1.5).command == "photo"


def of_take(label: str, start: float, stamp: float, body: str = "diver") -> RecognizedGesture:
    return RecognizedGesture(label, 0.9, stamp, "language", start, body)


@pytest.mark.parametrize("rules", [RULES, Rules(confirmed=False)])
def test_two_recognitions_of_one_take_never_confirm_each_other(rules: Rules) -> None:
    first, second = of_take("circle", 1.0, 4.0), of_take("circle", 1.04, 4.04)
    commands = commands_of(first, second, rules=rules)
    assert commands == ([None, None] if rules.confirmed else ["photo", None])
    repeated = commands_of(first, second, of_take("circle", 5.0, 8.0), rules=rules)
    assert repeated[-1] == "photo"


@pytest.mark.withstands(row="H27")
def test_only_the_same_body_confirms() -> None:
    first = of_take("circle", 1.0, 2.0)
    other = of_take("circle", 3.0, 4.0, body="other")
    assert commands_of(first, other) == [None, None]
    assert commands_of(first, of_take("circle", 3.0, 4.0)) == [None, "photo"]


@pytest.mark.parametrize("confidence", [math.nan, math.inf, -math.inf, 1.5])
def test_a_confidence_that_is_no_share_of_1_is_too_little(confidence: float) -> None:
    assert commands_of(shown("line", 1, confidence=confidence)) == [None]


def test_another_language_forgets_what_was_begun_in_the_old_one() -> None:
    made = dialogue()
    made.decide(shown("circle", 1), 1)
    decision = made.set_table(CommandTable("newer", TABLE.commands))
    assert decision is not None
    assert "'circle' is forgotten" in decision.reason
    assert made.decide(shown("circle", 2, language="newer"), 2).command is None


def test_the_same_language_again_forgets_nothing() -> None:
    made = dialogue()
    made.decide(shown("circle", 1), 1)
    assert made.set_table(CommandTable("language", dict(TABLE.commands))) is None
    assert made.decide(shown("circle", 2), 2).command == "photo"


def test_what_is_not_repeated_in_time_is_given_up_and_said_once() -> None:
    made = dialogue()
    made.decide(shown("circle", 1), 1)
    assert made.check_deadline(11.5) is None
    decision = made.check_deadline(12.5)
    assert decision is not None
    assert "not repeated in time" in decision.reason
    assert made.check_deadline(13.5) is None
    assert made.pending is None


@pytest.mark.parametrize(
    ("wrong", "error"),
    [
        ({"confirm_seconds": 0.0}, "confirm_seconds is 0.0"),
        ({"stale_seconds": math.nan}, "stale_seconds is nan"),
        ({"least_confidence": 1.5}, "least_confidence is 1.5"),
        ({"emergency_seconds": 0.0}, "emergency_seconds is 0.0"),
        ({"emergency_confidence": math.nan}, "emergency_confidence is nan"),
        ({"cancel": frozenset({"line"}), "emergency": frozenset({"line"})}, "'line'"),
    ],
)
def test_rules_that_contradict_themselves_are_refused(wrong: dict[str, object], error: str) -> None:
    with pytest.raises(ValueError, match=error):
        Rules(**wrong)  # type: ignore[arg-type]


gestures = st.builds(
    RecognizedGesture,
    label=st.sampled_from(LABELS),
    confidence=st.sampled_from([0.0, 0.4, 0.5, 1.0, math.nan]),
    stamp=st.integers(0, 60).map(float),
    language_id=st.sampled_from(["language", "language", "language", "older"]),
)
arrivals = st.lists(st.tuples(gestures, st.sampled_from([-2.0, 0.0, 0.5, 2.0])), max_size=30)


def decide_all(
    made: CommandDialogue, arrivals: list[tuple[RecognizedGesture, float]]
) -> list[Decision]:
    """Return the decisions on gestures that arrive some seconds after their stamp."""
    return [made.decide(gesture, gesture.stamp + late) for gesture, late in arrivals]


@given(arrivals)
@pytest.mark.withstands(row="H27")
def test_no_command_comes_of_a_rejected_stale_unsure_or_foreign_gesture(
    arrivals: list[tuple[RecognizedGesture, float]],
) -> None:
    for (gesture, late), decision in zip(arrivals, decide_all(dialogue(), arrivals), strict=True):
        if decision.command is not None:
            assert gesture.label is not None
            assert gesture.confidence >= RULES.least_confidence
            limit = RULES.emergency_seconds if decision.emergency else RULES.stale_seconds
            assert abs(late) <= limit
            assert gesture.language_id == TABLE.language_id
            assert decision.command == TABLE.commands[gesture.label]


@given(arrivals)
def test_every_command_but_an_emergency_was_shown_twice_in_time(
    arrivals: list[tuple[RecognizedGesture, float]],
) -> None:
    made = dialogue()
    for gesture, late in arrivals:
        before = made.pending
        decision = made.decide(gesture, gesture.stamp + late)
        if decision.command is not None and not decision.emergency:
            assert before is not None
            assert before.label == decision.label == gesture.label
            assert gesture.stamp <= before.deadline
            assert made.pending is None


@given(arrivals)
def test_a_pair_of_showings_gives_one_command_at_most(
    arrivals: list[tuple[RecognizedGesture, float]],
) -> None:
    decisions = decide_all(dialogue(), arrivals)
    confirmed = [each for each in decisions if each.command and not each.emergency]
    assert 2 * len(confirmed) <= sum(gesture.label is not None for gesture, _ in arrivals)


@given(arrivals)
def test_only_emergencies_are_marked_as_such(
    arrivals: list[tuple[RecognizedGesture, float]],
) -> None:
    for decision in decide_all(dialogue(), arrivals):
        assert decision.emergency == (decision.command is not None and decision.label == "line")
