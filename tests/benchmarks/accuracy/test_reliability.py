"""The confidence is fitted without a set and a person, and its bins say what it is worth."""

import numpy as np
import pytest

from benchmarks.accuracy.reliability import (
    REFUSED,
    Answer,
    count_bins,
    count_rejected,
    fit_confidence,
    leave_out,
)

QUERIES = 2000


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
    bins = {each.name: each for each in count_bins("drawn", answers)}
    for name, figure in bins.items():
        if name.endswith("confidence"):
            right = bins[name.replace("confidence", "right")]
            low, high = right.interval or (0.0, 0.0)
            assert low - 0.04 <= figure.value <= high + 0.04


def test_a_limit_of_its_own_rejects_its_share_of_the_right_takes() -> None:
    answers = [
        Answer("digits", 0, ("ann", "bob"), 0.5, index / 1000, 1.0, index < 500, True, index % 2)
        for index in range(1000)
    ]
    figures = {each.name: each for each in count_rejected("drawn", answers)}
    assert figures["drawn/rejected"].value == figures["drawn/accepted"].value == 0.5
    assert figures["drawn/rejected"].n == 500
    # All novelties of the others are above those of the language, of which 5 % are rejected.
    assert figures["drawn/accepted-by-own-limit"].value == 0.0
    assert REFUSED == 0.05


def test_a_set_and_who_made_the_query_have_no_part_in_its_confidence() -> None:
    odd = asked("letters", "bob", (-2.0, 0.1), 5) + asked("digits", "eve", (-2.0, 0.1), 6)
    others = asked("natops", "eve", (5.0, -3.0), 7)
    judged = [each for each in leave_out([*odd, *others])[0] if each.recorded == "digits"]
    fitted = fit_confidence(asked("letters", "bob", (-2.0, 0.1), 5))
    expected = 1 / (1 + np.exp(-fitted @ [1, judged[0].distance]))
    assert judged[0].confidence == pytest.approx(max(0.2, expected))
