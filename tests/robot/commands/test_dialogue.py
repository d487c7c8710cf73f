"""A command is given for a confirmed gesture or an emergency, and for nothing else."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.robot.commands.dialogue import (
    CommandDialogue,
    CommandTable,
    Decision,
    RecognizedGesture,
    RecognizedPhrase,
)
from app.robot.commands.replies import Reply, find_phrase_reply
from app.robot.commands.rules import EMERGENCY_LIMIT, Rules

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


def between(one: str, other: str, stamp: float, **of: Any) -> RecognizedGesture:
    return RecognizedGesture(None, 0.4, stamp, "language", pair=(one, other), **of)


def commands_of(*gestures: RecognizedGesture, rules: Rules = RULES) -> list[str | None]:
    made = dialogue(rules)
    return [made.decide(gesture, gesture.stamp).command for gesture in gestures]


@pytest.mark.parametrize(
    ("gestures", "answers"),
    [
        ([shown("circle", 1), shown("circle", 6)], [Reply.repeat, None]),
        ([shown("line", 1)], [None]),
        ([shown("circle", 1), shown("cross", 6)], [Reply.repeat, Reply.done]),
        ([between("circle", "peak", 1)], [Reply.one_of_two]),
        (
            [between("circle", "peak", 1), between("circle", "peak", 6)],
            [Reply.one_of_two, Reply.refused],
        ),
        ([shown(None, 1), shown("wave", 6), shown("circle", 9, 0.1)], [Reply.refused] * 3),
        # What is the same take again, or of somebody else, is no answer to this diver.
        (
            [shown("circle", 6), shown("circle", 6), shown("line", 7, language="other")],
            [Reply.repeat, None, None],
        ),
    ],
)
def test_what_a_diver_sees_of_a_gesture(
    gestures: list[RecognizedGesture], answers: list[Reply | None]
) -> None:
    made = dialogue()
    assert [made.decide(gesture, gesture.stamp).reply for gesture in gestures] == answers


@pytest.mark.parametrize(
    ("kind", "label", "pair", "answer"),
    [
        ("continues", "circle", None, Reply.listening),
        ("repeat", None, None, Reply.refused),
        ("repeat", None, ("circle", "peak"), Reply.one_of_two),
        ("cancelled", "cross", None, Reply.done),
        ("cancelled", None, None, Reply.refused),  # by the robot, which has lost it
        ("unexpected", "peak", None, Reply.refused),
        ("timed_out", None, None, Reply.refused),
        ("outside", "peak", None, Reply.refused),
        ("outside", None, None, None),
    ],
)
def test_what_a_diver_sees_of_a_part_of_a_message(
    kind: str, label: str | None, pair: tuple[str, str] | None, answer: Reply | None
) -> None:
    assert find_phrase_reply(kind, label, pair) is answer


def test_two_gestures_without_a_command_are_not_asked_about() -> None:
    decision = dialogue().decide(between("wave", "zigzag", 1), 1)
    assert (decision.reason, decision.reply) == (
        "'wave' and 'zigzag' have no command",
        Reply.refused,
    )
    assert dialogue().decide(between("wave", "circle", 1), 1).reply is Reply.one_of_two


@pytest.mark.parametrize(
    ("showings", "commands"),
    [
        pytest.param(["circle 1", "circle 6"], [None, "photo"], id="again"),
        pytest.param(["circle 1", "circle 2", "circle 3"], [None, "photo", None], id="thrice"),
        pytest.param(["circle 1", "circle 12", "circle 13"], [None, None, "photo"], id="too late"),
        pytest.param(
            ["circle 1", "peak 2", "circle 3", "circle 4"], [None] * 3 + ["photo"], id="another"
        ),
        pytest.param(["circle 1", "cross 2", "circle 3"], [None] * 3, id="cancelled"),
        pytest.param(["circle 1", "wave 2", "circle 3"], [None] * 3, id="without command"),
        pytest.param(["circle 1", "circle 1"], [None, None], id="played again"),
    ],
)
def test_a_gesture_is_confirmed_by_showing_it_again(
    showings: list[str], commands: list[str | None]
) -> None:
    shows = (each.split() for each in showings)
    assert commands_of(*(shown(label, float(second)) for label, second in shows)) == commands


def test_a_rejected_take_in_between_changes_nothing() -> None:
    gestures = [shown("circle", 1), shown(None, 2), shown("circle", 3)]
    assert commands_of(*gestures) == [None, None, "photo"]


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


@pytest.mark.parametrize("chosen", ["circle", "peak"])
def test_the_showing_after_a_pair_decides_and_confirms(chosen: str) -> None:
    made = dialogue()
    asked = made.decide(between("circle", "peak", 1), 1)
    assert (asked.command, asked.reason) == (None, "circle or peak? show it again")
    assert made.pending is not None
    assert (made.pending.label, made.pending.labels) == ("circle or peak", ("circle", "peak"))
    decided = made.decide(shown(chosen, 6), 6)
    assert (decided.command, decided.label) == (TABLE.commands[chosen], chosen)
    assert made.decide(shown(chosen, 7), 7).command is None


def test_a_second_pair_is_a_refusal_and_the_third_asks_again() -> None:
    made = dialogue()
    pairs = [between("circle", "peak", 1), shown(None, 2), between("peak", "circle", 3)]
    reasons = [made.decide(each, each.stamp).reason for each in pairs]
    assert reasons[-1] == "not understood; begin again"
    assert made.pending is None
    assert made.decide(shown("circle", 4), 4).command is None
    assert made.decide(between("peak", "wave", 30), 30).reason == "peak or wave? show it again"


def test_another_gesture_after_a_pair_is_shown_for_the_first_time() -> None:
    rules = Rules(confirm_seconds=10)
    gestures = [between("circle", "peak", 1), shown("line", 2), shown("line", 3)]
    assert commands_of(*gestures, rules=rules) == [None, None, "surface"]


def test_a_pair_confirms_nothing_and_only_what_was_shown_alone_before_needs_no_more() -> None:
    first = shown("circle", 1)
    assert commands_of(first, between("circle", "peak", 2), shown("circle", 3))[1:] == [
        None,
        "photo",
    ]
    assert commands_of(first, between("circle", "peak", 2), shown("peak", 3)) == [None] * 3
    assert commands_of(first, between("peak", "wave", 2), shown("circle", 3)) == [None] * 3
    assert commands_of(first, between("peak", "wave", 2), shown("peak", 3))[-1] == "follow"


@pytest.mark.parametrize(
    "second", [shown("circle", 12), RecognizedGesture("circle", 0.9, 5, "language", body_id="b")]
)
def test_a_showing_too_late_or_by_another_body_does_not_decide(second: RecognizedGesture) -> None:
    assert commands_of(between("circle", "peak", 1), second) == [None, None]


def test_a_pair_without_confirmation_commands_nothing() -> None:
    gestures = [between("circle", "peak", 1), between("circle", "peak", 2), shown("peak", 3)]
    assert commands_of(*gestures, rules=Rules(confirmed=False)) == [None, None, "follow"]


def test_a_pair_does_not_cancel_and_an_emergency_in_it_is_named_first_and_waits() -> None:
    made = dialogue()
    made.decide(shown("circle", 1), 1)
    assert not made.decide(between("cross", "circle", 2), 2).cancels
    asked = made.decide(between("peak", "line", 15), 15)
    assert (asked.command, asked.reason) == (None, "line or peak? show it again")
    decided = made.decide(shown("line", 16), 16)
    assert (decided.command, decided.emergency) == ("surface", True)


@pytest.mark.parametrize("age", [-2.0, 2.0, math.nan])
def test_a_stale_pair_asks_nothing(age: float) -> None:
    made = dialogue()
    assert made.decide(between("circle", "peak", 5), 5 + age).reason.startswith("ignored")
    assert made.pending is None


def test_the_take_of_a_pair_recognised_by_another_camera_does_not_answer_it() -> None:
    pair = between("circle", "peak", 4.0, start=1.0)
    again = RecognizedGesture("circle", 0.9, 4.04, "language", start=1.04)
    assert commands_of(pair, again) == [None, None]


@pytest.mark.parametrize(
    ("novelty", "command"),
    [
        (EMERGENCY_LIMIT, "surface"),
        (EMERGENCY_LIMIT + 0.01, None),
        (0.0, "surface"),
        (math.nan, None),
    ],
)
def test_an_emergency_has_a_limit_of_its_own(novelty: float, command: str | None) -> None:
    made = dialogue()
    decision = made.decide(replace(shown("line", 1), novelty=novelty), 1)
    assert decision.command == command
    assert made.decide(replace(shown("line", 2), novelty=0.99), 2).command is None
    # Other gestures are accepted as before.
    ordinary = [replace(shown("circle", second), novelty=0.99) for second in (3, 4)]
    assert [made.decide(each, each.stamp).command for each in ordinary] == [None, "photo"]


NO_NUMBERS = [math.nan, math.inf, -math.inf, True, "0.9", "1", None, [0.9], 10**400]


@pytest.mark.parametrize("field", ["confidence", "novelty", "start", "stamp"])
@pytest.mark.parametrize("number", NO_NUMBERS, ids=lambda number: str(number)[:8])
def test_a_gesture_with_a_number_that_is_none_commands_nothing(field: str, number: object) -> None:
    if (field, number) == ("start", None):  # it is not known
        return
    made = dialogue()
    missing: dict[str, Any] = {field: number}
    for label in ("line", "circle", "circle"):
        broken = replace(shown(label, 1), **missing)
        assert made.decide(broken, 1).command is None
        assert made.pending is None


@pytest.mark.parametrize("field", ["confidence", "start", "stamp"])
@pytest.mark.parametrize("number", NO_NUMBERS, ids=lambda number: str(number)[:8])
def test_a_message_with_a_number_that_is_none_commands_nothing(field: str, number: object) -> None:
    made = CommandDialogue(RULES)
    made.set_table(replace(TABLE, phrase_labels=frozenset({"circle"})))
    whole = replace(phrase_of(("peak", "line"), 2), kind="complete", mission="[1]", pair=None)
    missing: dict[str, Any] = {field: number}
    for _ in range(2):
        assert made.decide_phrase(replace(whole, **missing), 2).command is None
        assert made.pending is None


def phrase_of(pair: tuple[str, str], stamp: float) -> RecognizedPhrase:
    return RecognizedPhrase(
        kind="repeat",
        mission="",
        text="gesture 2: peak or line? show it again",
        confidence=0.9,
        start=stamp - 1,
        stamp=stamp,
        label=None,
        language_id="language",
        pair=pair,
    )


def test_a_pair_in_a_message_names_an_emergency_first_and_keeps_the_pending_message() -> None:
    made = dialogue()
    made.set_table(CommandTable("language", TABLE.commands, frozenset({"circle", "peak"})))
    whole = replace(
        phrase_of(("circle", "peak"), 1), kind="complete", mission="[]", label="peak", pair=None
    )
    made.decide_phrase(whole, 1)
    before = made.pending
    assert before is not None
    assert made.decide(between("circle", "peak", 2), 2).command is None
    assert made.decide_phrase(phrase_of(("circle", "peak"), 2), 2).reason.startswith("gesture 2")
    assert made.decide(between("peak", "line", 3), 3).reason == "line or peak? show it again"
    asked = made.decide_phrase(phrase_of(("peak", "line"), 3), 3)
    assert asked.reason == "line or peak? show it again"
    assert made.pending == before


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


shown_gestures = st.builds(
    RecognizedGesture,
    label=st.sampled_from(LABELS),
    confidence=st.sampled_from([0.0, 0.4, 0.5, 1.0, math.nan]),
    stamp=st.integers(0, 60).map(float),
    language_id=st.sampled_from(["language", "language", "language", "older"]),
)
pairs = st.permutations([label for label in LABELS if label]).map(lambda each: tuple(each[:2]))
gestures = st.one_of(
    shown_gestures,
    st.builds(lambda of, pair: replace(of, label=None, pair=pair), shown_gestures, pairs),
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
            assert gesture.label in before.labels
            assert decision.label == gesture.label
            assert gesture.stamp <= before.deadline
            assert made.pending is None


@given(arrivals)
def test_a_pair_of_showings_gives_one_command_at_most(
    arrivals: list[tuple[RecognizedGesture, float]],
) -> None:
    decisions = decide_all(dialogue(), arrivals)
    confirmed = [each for each in decisions if each.command and not each.emergency]
    answered = sum(bool(gesture.label or gesture.pair) for gesture, _ in arrivals)
    assert 2 * len(confirmed) <= answered


@given(arrivals)
def test_only_emergencies_are_marked_as_such(
    arrivals: list[tuple[RecognizedGesture, float]],
) -> None:
    for decision in decide_all(dialogue(), arrivals):
        assert decision.emergency == (decision.command is not None and decision.label == "line")
