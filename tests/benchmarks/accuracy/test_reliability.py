"""Limits reject their share of true takes; the confidence is fitted without a set and a person."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.accuracy.reliability import (
    REFUSED,
    Answer,
    Outcomes,
    accepted_at_own_limits,
    accepted_by_limit,
    fit_confidence,
    leave_out,
    refused_by_limit,
    reliability,
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


def asked(recorded: str, person: str, truth: tuple[float, float], seed: int) -> list[Answer]:
    """Draw answers that are right with the confidence by some coefficients."""
    generator = np.random.default_rng(seed)
    distances = generator.uniform(0.2, 4, QUERIES)
    chances = 1 / (1 + np.exp(-(truth[0] + truth[1] * distances)))
    right = generator.random(QUERIES) < chances
    return [
        Answer(
            recorded, 0, ("ann", person), float(chance), 0.5, float(distance), True, bool(hit), 1
        )
        for chance, distance, hit in zip(chances, distances, right, strict=True)
    ]


def test_the_confidence_that_takes_were_drawn_by_is_found_again_and_has_no_bin_far_off() -> None:
    answers = asked("digits", "bob", (5.0, -3.0), 4)
    assert fit_confidence(answers) == pytest.approx([5.0, -3.0], abs=0.5)
    assert not any("!" in line for line in reliability(answers))
    assert "!" in "".join(reliability([replace(each, confidence=0.5) for each in answers]))


def test_a_set_and_who_made_the_query_have_no_part_in_its_confidence() -> None:
    odd = asked("letters", "bob", (-2.0, 0.1), 5) + asked("digits", "eve", (-2.0, 0.1), 6)
    others = asked("natops", "eve", (5.0, -3.0), 7)
    judged = [each for each in leave_out([*odd, *others]) if each.recorded == "digits"]
    fitted = fit_confidence(asked("letters", "bob", (-2.0, 0.1), 5))
    expected = 1 / (1 + np.exp(-fitted @ [1, judged[0].distance]))
    assert judged[0].confidence == pytest.approx(max(0.2, expected))
