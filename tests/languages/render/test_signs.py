"""Rendered signs: held still between two salutes, each with a hand of its own."""

from itertools import combinations

import numpy as np
import pytest

from languages.render.performance import Manner
from languages.render.signs import SIGNS, hold_sign

RATE = 25


@pytest.mark.parametrize("name", SIGNS)
def test_a_sign_is_held_between_two_salutes(name: str) -> None:
    performance = hold_sign(SIGNS[name], Manner(), RATE, seed=1)
    names = [phase.name for phase in performance.phases]
    assert names.index("salute") < names.index("stroke") < len(names) - names[::-1].index("salute")
    (stroke,) = (phase for phase in performance.phases if phase.name == "stroke")
    held = performance.right[round(stroke.start * RATE) : round(stroke.end * RATE)]
    assert all(np.array_equal(each.fingers, SIGNS[name].fingers) for each in held)
    places = np.array([each.wrist for each in held])
    assert np.ptp(places, axis=0).max() < 0.05


def test_no_two_signs_are_the_same() -> None:
    for one, other in combinations(SIGNS.values(), 2):
        parts = (
            (one.fingers, other.fingers),
            (one.pointing, other.pointing),
            (one.palm, other.palm),
        )
        elsewhere = not np.allclose(one.wrist, other.wrist)
        assert elsewhere or any(not np.allclose(*part) for part in parts)
