"""Limits of the novelty: each rejects the share of true takes that it promises."""

import numpy as np
import pytest

from benchmarks.accuracy.reliability import (
    REFUSED,
    Outcomes,
    accepted_at_own_limits,
    accepted_by_limit,
    refused_by_limit,
    with_interval,
)

QUERIES = 2000


def drawn(true: float, foreign: float, seed: int) -> Outcomes:
    """Draw novelties about two means; a language rejects those above 1."""
    generator = np.random.default_rng(seed)
    known = np.arange(QUERIES) % 2 == 0
    novelty = generator.normal(np.where(known, true, foreign), 0.2)
    return Outcomes(novelty, known, novelty > 1, np.arange(QUERIES) // 20)


NEAR, FAR = drawn(0.5, 0.9, seed=1), drawn(0.5, 2.0, seed=2)
LOOSE = drawn(0.8, 2.0, seed=3)


def test_a_sets_own_limit_refuses_its_share_of_the_true_takes() -> None:
    for outcomes in (NEAR, FAR, LOOSE):
        refused = (outcomes.novelty[outcomes.known] > outcomes.own_limit).mean()
        assert refused == pytest.approx(REFUSED, abs=0.002)


def test_what_is_far_is_never_accepted_and_what_is_near_mostly_is() -> None:
    assert accepted_at_own_limits([FAR]) == 0
    assert accepted_by_limit([NEAR]) > 0.5
    assert refused_by_limit([NEAR]) < 0.02


def test_an_interval_holds_what_was_measured() -> None:
    measured, low, high = (
        float(word.strip("(%)"))
        for word in with_interval(accepted_by_limit, [NEAR]).split()
        if word != "to"
    )
    assert low < measured < high
    assert 2 < high - low < 8
