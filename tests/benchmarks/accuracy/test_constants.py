"""Constants of the decision: chosen without a set and its people, within what is allowed."""

import numpy as np
import pytest

from benchmarks.accuracy.constants import (
    FAR_ACCEPTED,
    Decided,
    choose_limit,
    without_people_of,
)

TAKES = 4000


def decided(right: float, near: float, far: float | None, seed: int) -> Decided:
    """Draw scores about three means; without `far` there are no far movements."""
    generator = np.random.default_rng(seed)
    means = {"right": right, "near": near} | ({} if far is None else {"far": far})
    kind = np.repeat([*means], TAKES)
    scores = generator.normal([means[each] for each in kind], 0.1).clip(0.01)
    return Decided(0.8, kind, scores / 0.8)


def test_a_limit_accepts_few_far_movements_of_every_set() -> None:
    sets = [decided(0.5, 0.7, far, seed=1) for far in (1.2, 0.9, 1.5)]
    limit = choose_limit(sets)
    accepted = [each.accepted("far", limit).value or 0.0 for each in sets]
    assert max(accepted) == pytest.approx(FAR_ACCEPTED, abs=0.001)
    assert accepted[1] == max(accepted)


def test_a_limit_without_far_movements_lies_between_right_and_near_takes() -> None:
    assert choose_limit([decided(0.3, 0.6, None, seed=2)]) == pytest.approx(0.45, abs=0.04)


def test_sets_of_the_same_people_are_left_out_together() -> None:
    names = ["digits", "carried_letters", "natops", "utd_other", "utd_figures", "utkinect"]
    assert without_people_of(names, "digits") == names[2:]
    assert without_people_of(names, "utd_other") == ["digits", "carried_letters", *names[2::3]]
    assert "natops" not in without_people_of(names, "natops")
