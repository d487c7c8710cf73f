"""Arms: the places of hands according to the pose."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.landmark_models.arms import (
    REACH,
    measure_body,
    region_of_wrist,
    regions_of_forearm,
    wrist_distance,
)
from app.recognition.poses.frame import SIDES, Body, Hand, Side
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from tests.recognition.estimation.drawn_hand import flat_hand, turned

HAND_POINTS = {"wrist": "wrist", "pinky": "pinky_mcp", "index": "index_finger_mcp"}
"""The pose's points of a hand, and the hand model's points at the same places."""


def body_with(hand: FloatArray, side: Side, *, visibility: float = 1.0) -> Body:
    """Return a body of which only the end of one arm is known, at the place of `hand` (21, 2)."""
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


def standing(*, wrist: tuple[float, float] = (400.0, 300.0)) -> Body:
    """Return a body whose left forearm points from (300, 300) to `wrist`; its torso is 200 long."""
    places = {
        "left_shoulder": (340.0, 100.0),
        "right_shoulder": (260.0, 100.0),
        "left_hip": (330.0, 300.0),
        "right_hip": (270.0, 300.0),
        "left_elbow": (300.0, 300.0),
        "left_wrist": wrist,
    }
    xy: FloatArray = np.full((len(POSE_LANDMARKS), 2), np.nan)
    for name, place in places.items():
        xy[POSE_LANDMARKS.index(name)] = place
    return Body(xy, np.ones(len(POSE_LANDMARKS)), 1.0)


def test_the_hand_in_a_glove_is_sought_beyond_the_wrist_at_the_body_s_scale() -> None:
    regions = regions_of_forearm(standing(), "left")
    assert [region.side for region in regions] == [120, 180]
    for region in regions:
        assert (region.x, region.y) == pytest.approx((440, 300))
        assert region.rotation == pytest.approx(math.pi / 2), "fingers point on from the forearm"


def test_a_forearm_that_was_not_seen_has_no_regions() -> None:
    assert regions_of_forearm(standing(), "right") == ()
    assert regions_of_forearm(body_with(flat_hand(), "left", visibility=0.4), "left") == ()


def test_a_body_seen_from_the_side_is_as_long_as_its_torso() -> None:
    assert measure_body(standing()) == pytest.approx(200)
