"""Hand variation: variants are the same shape, farther by another person, and repeatable."""

import numpy as np
import pytest

from app.recognition import Gesture
from app.recognition.poses.frame import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.simulation.variation import HAND_SPREADS, Person, draw_variants, vary_hands
from app.recognition.voters.hand_voters import HandVoter
from app.recognition.voters.registry import HAND_VOTERS
from tests.recognition.held_takes import FLAT, TWO, hold
from tests.recognition.parametric_hand import hand_xy

HAND = HandShape.of_frames("right", hand_xy(TWO)[None])


def distances(person: Person, voter: HandVoter) -> FloatArray:
    varied = vary_hands([HAND], 60, HAND_SPREADS[person])
    described = np.array([voter.describe(hand) for (hand,) in varied])
    return voter.distances(voter.describe(HAND), described)


@pytest.mark.parametrize("voter", HAND_VOTERS, ids=lambda voter: voter.name)
def test_another_person_varies_more_but_shows_the_same_shape(voter: HandVoter) -> None:
    same = float(np.median(distances("same", voter)))
    another = float(np.median(distances("another", voter)))
    assert 0.3 * voter.within < another < 2 * voter.within
    assert same < another < voter.between / 2


def test_a_larger_count_begins_with_the_same_variants() -> None:
    few, many = (vary_hands([HAND], count, HAND_SPREADS["same"], seed=4) for count in (2, 5))
    assert all(
        np.array_equal(one.xy, other.xy) for (one,), (other,) in zip(few, many, strict=False)
    )


def test_variants_of_a_held_demonstration_vary_its_hand_alone() -> None:
    shown = Gesture.from_demonstration("stop", hold(FLAT)).trajectory
    assert shown is not None
    for variant in draw_variants(shown, 3, person="another"):
        assert np.array_equal(variant.xy, shown.xy, equal_nan=True)
        assert not np.array_equal(variant.hands[0].xy, shown.hands[0].xy)
