"""Simulated trials: distant gestures are never confused, equal ones always may be."""

import numpy as np
import pytest

from app.recognition import Language, Recognizer
from app.recognition.health.simulated_trials import SimulatedTrials, simulate_trials
from tests.recognition.demonstrations import pool, shown
from tests.recognition.strategies import circle, line, wedge


def rate_of(trials: SimulatedTrials, performer: int, other: int) -> float:
    estimate = trials.confusion(performer, other)
    assert estimate is not None
    return estimate.rate


def test_a_line_is_not_taken_for_a_circle() -> None:
    trials = simulate_trials(Recognizer(pool(circle=circle, line=line), "full"), 8, person="same")
    assert trials.scores.shape == (2, 8, 2)
    assert trials.scores.argmin(axis=2).tolist() == [[0] * 8, [1] * 8]
    assert rate_of(trials, 0, 1) < 0.05
    assert trials.misread(1).rate < 0.05


def test_the_same_demonstration_twice_is_a_guess() -> None:
    language = pool(circle=circle, ring=circle)
    trials = simulate_trials(Recognizer(language, "full"), 4)
    assert rate_of(trials, 0, 1) == pytest.approx(0.5)
    assert rate_of(trials, 1, 0) == pytest.approx(0.5)


def test_what_is_refused_or_misread_is_missed() -> None:
    trials = simulate_trials(Recognizer(pool(circle=circle, line=line), "full"), 6)
    for performer in range(2):
        missed = trials.missed(performer).rate
        assert missed >= trials.refused(performer).rate
        assert missed >= trials.misread(performer).rate
    assert 0 < trials.refused(0).rate < 0.3


def test_only_the_gestures_asked_for_are_performed() -> None:
    recognizer = Recognizer(pool(circle=circle, line=line, wedge=wedge), "full")
    whole = simulate_trials(recognizer, 3)
    some = simulate_trials(recognizer, 3, gestures=[2])
    assert some.gestures.tolist() == [2]
    np.testing.assert_array_equal(some.scores[0], whole.scores[2])


def test_a_language_of_one_gesture_is_never_misread() -> None:
    trials = simulate_trials(Recognizer(Language("one", [shown("circle", circle)]), "full"), 3)
    assert trials.misread(0).rate < 1e-5


def test_every_take_is_announced_and_an_exception_ends_it() -> None:
    recognizer = Recognizer(pool(circle=circle, line=line), "full")
    announced = []

    def advance() -> None:
        announced.append(1)
        if len(announced) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate_trials(recognizer, 4, advance=advance)
    assert len(announced) == 3
