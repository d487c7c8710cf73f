"""Fusion: a voter has the say that the language gives it."""

import numpy as np
import pytest

from app.recognition.decision.fused_vote import VOTERS
from app.recognition.decision.fusion import TYPICAL, fused, says


def say_of(voter: str, between: float, landmarks: int = 1, pairs: int = 10) -> float:
    say, _ = says([voter], [np.full(pairs, between)], landmarks)
    return float(say[0])


def test_every_voter_is_known() -> None:
    assert set(VOTERS) == set(TYPICAL)


def test_a_voter_that_cannot_tell_the_gestures_apart_has_no_say() -> None:
    for voter in VOTERS:
        assert say_of(voter, between=TYPICAL[voter].within) == 0.0
        assert say_of(voter, between=0.0) == 0.0


def test_the_farther_apart_the_gestures_the_more_say() -> None:
    within = TYPICAL["path"].within
    grown = [say_of("path", within * factor) for factor in (1.5, 3, 10, 100)]
    assert grown == sorted(grown)
    assert grown[-1] < TYPICAL["path"].prior


def test_a_single_gesture_is_judged_by_what_is_typical() -> None:
    say, between = says(["path"], [np.empty(0)], 1)
    assert between[0] == TYPICAL["path"].between
    assert say[0] > 0.9


def test_direction_shares_its_say_among_the_landmarks() -> None:
    assert say_of("direction", 1.3, landmarks=4) == pytest.approx(say_of("direction", 1.3) / 4)


def test_scores_do_not_depend_on_the_voters_units() -> None:
    distances = np.array([[1.0, 2.0], [30.0, 10.0]])
    say, between = np.array([1.0, 0.5]), np.array([2.0, 20.0])
    scores = fused(distances, say, between)
    np.testing.assert_allclose(scores, [(0.5 + 0.5 * 1.5) / 1.5, (1.0 + 0.5 * 0.5) / 1.5])
    scaled = fused(distances * [[1.0], [7.0]], say, between * (1.0, 7.0))
    np.testing.assert_allclose(scaled, scores)


def test_who_cannot_compare_abstains() -> None:
    distances = np.array([[1.0, np.inf, np.inf], [30.0, 10.0, np.inf]])
    scores = fused(distances, np.array([1.0, 1.0]), np.array([1.0, 10.0]))
    np.testing.assert_allclose(scores, [2.0, 1.0, np.inf])
