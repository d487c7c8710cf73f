"""Where the pose says that a hand is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.landmark_models.arms import REACH, region_of_wrist, wrist_distance
from app.recognition.poses.frame import SIDES, Body, Hand, Side
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from tests.recognition.estimation.drawn_hand import flat_hand, turned

HAND_POINTS = {"wrist": "wrist", "pinky": "pinky_mcp", "index": "index_finger_mcp"}
"""The pose's points of a hand, and the hand model's points at the same places."""


def body_with(hand: FloatArray, side: Side, *, visibility: float = 1.0) -> Body:
    """Return a body of which only the end of one arm is known: where `hand` (21, 2) is."""
    xy: FloatArray = np.full((len(POSE_LANDMARKS), 2), np.nan)
    for pose_point, hand_point in HAND_POINTS.items():
        place = POSE_LANDMARKS.index(f"{side}_{pose_point}")
        xy[place] = hand[HAND_LANDMARKS.index(hand_point)]
    return Body(xy, np.full(len(POSE_LANDMARKS), visibility), 1.0)


@given(
    st.sampled_from(SIDES),
    st.floats(-math.pi, math.pi),
    st.floats(15, 400),
    st.tuples(st.floats(-500, 2500), st.floats(-500, 2500)),
)
def test_the_whole_hand_lies_upright_in_the_region(
    side: Side, angle: float, size: float, place: tuple[float, float]
) -> None:
    hand = turned(flat_hand(size=size), angle) + place
    region = region_of_wrist(body_with(hand, side), side)
    assert region is not None
    shown = region.to_crop(hand, 224)
    assert ((shown > 0) & (shown < 224)).all()
    wrist, middle_tip = shown[0], shown[HAND_LANDMARKS.index("middle_finger_tip")]
    assert wrist[1] - middle_tip[1] > 100
    assert abs(wrist[0] - middle_tip[0]) < 40


def test_the_hand_of_a_hidden_wrist_is_not_looked_for() -> None:
    assert region_of_wrist(body_with(flat_hand(), "left", visibility=0.05), "left") is None


def test_an_arm_that_was_not_seen_has_no_region() -> None:
    assert region_of_wrist(body_with(flat_hand(), "left"), "right") is None


def test_a_hand_without_extent_has_no_region() -> None:
    assert region_of_wrist(body_with(np.zeros((21, 2)), "left"), "left") is None


@pytest.mark.parametrize("size", [10.0, 300.0])
def test_distance_to_the_wrist_is_told_in_palms(size: float) -> None:
    hand = Hand(flat_hand(size=size), "left", 1.0)
    body = body_with(hand.xy, "left")
    assert wrist_distance(hand, body, "left") == 0
    next_to_it = Hand(hand.xy + (2 * size, 0), "left", 1.0)
    assert wrist_distance(next_to_it, body, "left") > REACH
