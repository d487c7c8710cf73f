"""Hand voters: what they tell apart, and what they must not see."""

import numpy as np
import pytest

from app.recognition.poses.frame import HandShape
from app.recognition.voters.hand_voters import HandVoter
from app.recognition.voters.registry import HAND_VOTERS
from tests.recognition.held_takes import FIST, FLAT, TWO
from tests.recognition.parametric_hand import Fingers, View, hand_xy

VOTERS = pytest.mark.parametrize("voter", HAND_VOTERS, ids=lambda voter: voter.name)


def shape(fingers: Fingers, view: View | None = None) -> HandShape:
    return HandShape.of_frames("right", hand_xy(fingers, view)[None])


def apart(voter: HandVoter, one: HandShape, other: HandShape) -> float:
    return float(voter.distances(voter.describe(one), voter.describe(other)[None])[0])


@VOTERS
def test_a_hand_is_at_distance_0_of_itself(voter: HandVoter) -> None:
    assert apart(voter, shape(TWO), shape(TWO)) == 0


@VOTERS
def test_a_little_turn_in_the_image_is_not_seen(voter: HandVoter) -> None:
    # The projected hand is in perspective, so that its own turn would change it.
    hand = shape(TWO)
    assert apart(voter, hand, hand.turn(25)) < 0.01
    assert apart(voter, hand, hand.turn(40)) < 0.3 * voter.between
    assert apart(voter, hand, hand.turn(-40)) == pytest.approx(
        apart(voter, hand, hand.turn(40)), abs=0.01
    )


def test_up_and_down_are_far_apart() -> None:
    *oriented, tips = HAND_VOTERS
    for voter in oriented:
        assert apart(voter, shape(TWO), shape(TWO).turn(180)) > 1.5 * voter.between
    # Fingertips are as far from each other in any orientation.
    assert apart(tips, shape(TWO), shape(TWO).turn(180)) < 1e-9


@VOTERS
def test_stretched_fingers_are_told_from_bent_ones(voter: HandVoter) -> None:
    shapes = [shape(FLAT), shape(FIST), shape(TWO)]
    for index, one in enumerate(shapes):
        for other in shapes[index + 1 :]:
            assert apart(voter, one, other) > 2 * voter.within


@VOTERS
def test_a_hand_turned_about_its_axis_stays_near(voter: HandVoter) -> None:
    turned = shape(TWO, View(yaw=20))
    assert apart(voter, shape(TWO), turned) < apart(voter, shape(TWO), shape(FLAT))


@VOTERS
def test_the_distance_to_many_is_the_distance_to_each(voter: HandVoter) -> None:
    others = [voter.describe(shape(each)) for each in (FLAT, FIST, TWO)]
    query = voter.describe(shape(TWO, View(yaw=10)))
    together = voter.distances(query, np.array(others))
    alone = [voter.distances(query, other[None])[0] for other in others]
    assert np.allclose(together, alone)
