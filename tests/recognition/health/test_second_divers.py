"""Advice on second divers: the gestures missed when other people show them, the worst first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.recognition import Gesture, Language, check_health
from app.recognition.health.report import MOST_MISSED, GestureHealth
from app.recognition.health.second_divers import MOST_NAMED, advise_second_divers
from app.recognition.simulation.rate_estimate import RateEstimate
from tests.recognition.strategies import SHAPES, circle, recording


def shown(label: str, diver: str = "") -> Gesture:
    return Gesture.from_demonstration(label, recording(SHAPES[label]), diver=diver)


def health(label: str, rate: float | None) -> GestureHealth:
    missed = None if rate is None else RateEstimate(rate, rate / 2, min(1.0, 2 * rate))
    return GestureHealth(
        label=label,
        seconds=2.0,
        landmarks=(),
        missed=missed,
        refused=missed,
        false_alarms=None,
        set_off_by=(),
    )


def advice(gestures: list[Gesture], rates: list[float | None]) -> list[tuple[str, ...]]:
    estimates = [health(each.label, rate) for each, rate in zip(gestures, rates, strict=True)]
    return [found.gestures for found in advise_second_divers(Language("pool", gestures), estimates)]


def test_the_gestures_that_others_are_missed_for_are_named_the_worst_first() -> None:
    gestures = [shown(label) for label in SHAPES]
    over = MOST_MISSED + 0.01
    assert advice(gestures, [over, MOST_MISSED, 0.5, None, 0.3]) == [("line", "square", "circle")]
    assert advice(gestures, [0.2, 0.3, 0.4, 0.5, 0.6]) == [("square", "infinity", "line")]
    assert MOST_NAMED == 3
    assert advice(gestures, [0.0] * 5) == []
    assert advice([], []) == []


@pytest.mark.parametrize(
    ("first", "second", "named"),
    [("Ana", "Ben", False), ("Ana", "Ana", True), ("", "", False), ("Ana", "", False)],
)
def test_a_gesture_of_two_divers_needs_no_other(first: str, second: str, named: bool) -> None:
    both = shown("circle", first).with_demonstration(recording(circle, jitter=0.01), second)
    assert advice([both], [0.5]) == ([("circle",)] if named else [])


def test_the_sentence_says_what_to_do() -> None:
    gestures = [shown("circle"), shown("line")]
    (found,) = advise_second_divers(
        Language("pool", gestures), [health("circle", 0.4), health("line", 0.2)]
    )
    assert found.code == "one_diver"
    assert not found.below_bar
    assert found.message.startswith(
        "a second diver's demonstration would help most for circle and line"
    )


@pytest.mark.slow
@pytest.mark.parametrize(("person", "named"), [("another", True), ("same", False)])
def test_a_report_for_other_people_has_the_advice(person: str, named: bool) -> None:
    nearly = recording(lambda share: circle(share) * np.array([1.0, 0.95]))
    gestures = [shown("circle"), Gesture.from_demonstration("egg", nearly)]
    report = check_health(Language("eggs", gestures), person=person, takes=4)  # type: ignore[arg-type]
    assert report.gestures[0].missed is not None
    assert report.gestures[0].missed.rate > MOST_MISSED
    assert ("one_diver" in {each.code for each in report.findings}) == named
    both = [replace(each, diver="Ana").with_demonstration(nearly, "Ben") for each in gestures]
    again = check_health(Language("eggs", both), person="another", takes=4)
    assert "one_diver" not in {each.code for each in again.findings}
