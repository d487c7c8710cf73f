"""Moving hands: which shape a hand keeps while it moves, and when it keeps none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.recognition.poses.frame import HandShape
from app.recognition.preprocessing.moving_hands import find_moving_hands, list_moving_sides
from tests.recognition.held_takes import FIST, FLAT, TWO
from tests.recognition.moving_takes import circle, draw, without_hands


def distance(one: HandShape, other: HandShape) -> float:
    return float(np.sqrt(((one.xy - other.xy) ** 2).sum(axis=1).mean()))


def test_a_hand_that_turns_with_the_arm_keeps_its_shape() -> None:
    (still,) = find_moving_hands(draw(TWO, circle()), ["right"])
    (turning,) = find_moving_hands(draw(TWO, circle(), turning=35.0, seed=1), ["right"])
    assert distance(still, turning) < 0.05


def test_frames_of_another_shape_do_not_change_the_median() -> None:
    take, other = draw(FLAT, circle()), draw(FIST, circle())
    assert take.hands is not None
    assert other.hands is not None
    hands = take.hands.copy()
    hands[:15] = other.hands[:15]
    (mixed,) = find_moving_hands(replace(take, hands=hands), ["right"])
    (flat,) = find_moving_hands(take, ["right"])
    assert distance(mixed, flat) < 0.1


@pytest.mark.parametrize(("seen", "found"), [(0.3, 1), (0.2, 0), (0.0, 0)])
def test_a_hand_must_be_seen_in_a_quarter_of_the_frames(seen: float, found: int) -> None:
    assert len(find_moving_hands(draw(FIST, circle(), seen=seen), ["right"])) == found


def test_a_hand_whose_landmarks_jump_about_keeps_no_shape() -> None:
    take = draw(FLAT, circle())
    assert take.hands is not None
    noisy = take.hands + np.random.default_rng(0).normal(0, 30, take.hands.shape)
    assert find_moving_hands(replace(take, hands=noisy), ["right"]) == ()


def test_a_source_without_hands_shows_no_shape() -> None:
    assert find_moving_hands(without_hands(draw(FLAT, circle()))) == ()


def test_the_arms_that_carry_a_movement_are_named_by_its_landmarks() -> None:
    assert list_moving_sides(["right_wrist", "nose"]) == ("right",)
    assert list_moving_sides(["WristRight", "left_elbow"]) == ("left", "right")
    assert list_moving_sides(["nose"]) == ()
