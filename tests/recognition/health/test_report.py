"""The limit in the health report: its two costs follow the dial."""

import json
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from app.recognition import Gesture, Language, Recognizer
from app.recognition.health.check import check_health
from app.recognition.health.report import LimitHealth
from tests.recognition.demonstrations import pool, shown_by
from tests.recognition.held_takes import FIST, hold
from tests.recognition.strategies import circle, line, square, wedge

DIVERS = ("Ann", "Bo", "Cy")
ALIKE = {"circle": circle, "ring": circle, "wedge": wedge, "square": square}
THREE = shown_by(DIVERS, ALIKE)


def limit_at(share: float, language: Language = THREE) -> LimitHealth:
    limit = LimitHealth.measure(Recognizer(replace(language, most_refused=share)))
    assert limit is not None
    return limit


@given(st.floats(0.001, 0.5), st.floats(0.001, 0.5))
def test_who_may_refuse_more_right_takes_accepts_fewer_of_missing_gestures(
    one: float, other: float
) -> None:
    lenient, strict = limit_at(min(one, other)), limit_at(max(one, other))
    assert lenient.limit >= strict.limit
    for before, after in ((lenient.refused, strict.refused), (strict.accepted, lenient.accepted)):
        assert before is not None
        assert after is not None
        assert before.rate <= after.rate


@given(st.floats(0.001, 0.5))
def test_no_more_right_takes_are_refused_than_the_dial_says_by_one_take(share: float) -> None:
    limit = limit_at(share)
    assert limit.measured
    assert limit.refused is not None
    assert limit.refused.rate <= share + 1 / limit.refused.n


def test_a_gesture_that_is_another_one_too_is_accepted_where_the_language_lacks_it() -> None:
    limit = limit_at(0.05)
    assert limit.accepted is not None
    assert limit.accepted.rate == 0.5  # circle and ring of four gestures


def test_one_person_measures_neither_cost() -> None:
    limit = check_health(pool(circle=circle, line=line)).to_dict()["limit"]
    assert limit["limit"] > 0
    assert (limit["people"], limit["most_refused"], limit["measured"]) == (1, 0.05, False)
    assert limit["refused"] is limit["accepted"] is None


def test_two_people_with_few_gestures_measure_the_costs_of_the_constant() -> None:
    two = shown_by(("Ann", "Bo"))
    few = replace(two, gestures=two.gestures[:3])
    strict, lenient = limit_at(0.5, few), limit_at(0.02, few)
    assert not strict.measured
    assert strict.refused is not None
    assert strict.accepted is not None
    assert strict.refused.n == strict.accepted.n == 6
    assert (strict.limit, strict.refused) == (lenient.limit, lenient.refused)


def test_the_costs_are_plain_json_with_their_numbers_of_takes() -> None:
    content = check_health(THREE).to_dict()["limit"]
    assert json.loads(json.dumps(content, allow_nan=False)) == content
    assert content["people"] == 3
    for cost in (content["refused"], content["accepted"]):
        assert cost["n"] == len(DIVERS) * len(ALIKE)
        assert cost["low"] <= cost["rate"] <= cost["high"]


def test_a_language_of_held_shapes_has_no_limit_of_movements() -> None:
    fist = Gesture.from_demonstration("fist", hold(FIST))
    assert LimitHealth.measure(Recognizer(Language("signs", [fist]))) is None
