"""Fusion: a voter gets the weight that it has in a language."""

import numpy as np
import pytest

from app.recognition.decision.fusion import fuse, weigh_voters
from app.recognition.voters.motion_voters import Path, Place
from app.recognition.voters.registry import MOTION_VOTERS
from app.recognition.voters.voter import WeightedVoter


def weight_of(voter: WeightedVoter, between: float, arms: bool = False, pairs: int = 10) -> float:
    weights, _ = weigh_voters([voter], [np.full(pairs, between)], arms=arms)
    return float(weights[0])


def test_a_voter_that_cannot_tell_the_gestures_apart_gets_no_weight() -> None:
    for voter in MOTION_VOTERS:
        if voter.within:
            assert weight_of(voter, between=voter.within) == 0.0
            assert weight_of(voter, between=0.0) == 0.0


def test_the_farther_apart_the_gestures_the_more_weight() -> None:
    within = Place.within
    grown = [weight_of(Place(), within * factor) for factor in (1.5, 3, 10, 100)]
    assert grown == sorted(grown)
    assert grown[-1] < Place.prior


def test_a_single_gesture_is_judged_by_what_is_typical() -> None:
    weights, between = weigh_voters([Place()], [np.empty(0)], arms=True)
    assert between[0] == Place.between
    assert weights[0] > 0.4 * Place.prior


def test_the_path_has_weight_where_hands_alone_are_seen() -> None:
    assert weight_of(Path(), 0.8) == pytest.approx(Path.prior)
    assert weight_of(Path(), 0.8, arms=True) == 0.0


def test_scores_do_not_depend_on_the_voters_units() -> None:
    distances = np.array([[1.0, 2.0], [30.0, 10.0]])
    weights, between = np.array([1.0, 0.5]), np.array([2.0, 20.0])
    scores = fuse(distances, weights, between)
    np.testing.assert_allclose(scores, [(0.5 + 0.5 * 1.5) / 1.5, (1.0 + 0.5 * 0.5) / 1.5])
    scaled = fuse(distances * [[1.0], [7.0]], weights, between * (1.0, 7.0))
    np.testing.assert_allclose(scaled, scores)


def test_who_cannot_compare_abstains() -> None:
    distances = np.array([[1.0, np.inf, np.inf], [30.0, 10.0, np.inf]])
    scores = fuse(distances, np.array([1.0, 1.0]), np.array([1.0, 10.0]))
    np.testing.assert_allclose(scores, [2.0, 1.0, np.inf])
