"""Arms: the places of hands according to the pose."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.landmark_models.arms import (
    FAR,
    MOST_MISSES,
    REACH,
    STEER_SECONDS,
    ArmPace,
    ArmPaces,
    find_far_arm,
    measure_body,
    region_of_wrist,
    regions_of_forearm,
    wrist_distance,
)
from app.recognition.poses.frame import SIDES, Body, Hand, Side
from app.recognition.poses.landmarks import HAND_LANDMARKS, POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from tests.recognition.estimation.drawn_hand import flat_hand, turned
from tests.recognition.estimation.landmark_models.crops import to_crop

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
    shown = to_crop(region, hand, 224)
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


TORSO = 200.0
"""Pixels of the torso of a body that stands upright, its hips at y = 400."""


def holding(height: float, across: float = 0.0) -> Body:
    """Return a body whose right wrist is so many torso lengths above the hips, and to the side."""
    xy: FloatArray = np.full((len(POSE_LANDMARKS), 2), np.nan)
    for side, x in (("left", 350.0), ("right", 250.0)):
        xy[POSE_LANDMARKS.index(f"{side}_shoulder")] = x, 400 - TORSO
        xy[POSE_LANDMARKS.index(f"{side}_hip")] = x, 400
    xy[POSE_LANDMARKS.index("right_wrist")] = 200 + TORSO * across, 400 - TORSO * height
    return Body(xy, np.ones(len(POSE_LANDMARKS)), 1.0)


def count_looks(bodies: list[Body], rate: float = 25.0, *, spares: bool = False) -> int:
    """Return in how many frames the hand of the right arm is due, and looked at."""
    paces, looks = ArmPaces(spares=spares), 0
    for number, body in enumerate(bodies):
        (pace,) = paces.update([(body, "right")], number / rate)
        if pace.is_due(number / rate):
            pace.read, looks = number / rate, looks + 1
    return looks


@pytest.mark.parametrize("rate", [24.0, 25.0, 30.0])
def test_a_hand_that_is_held_up_is_looked_at_in_every_second_frame(rate: float) -> None:
    assert count_looks([holding(1.2)] * 50, rate) == pytest.approx(25, abs=1)


def test_a_hand_that_hangs_is_looked_at_three_times_a_second() -> None:
    assert count_looks([holding(-0.3)] * 75) == pytest.approx(10, abs=1)


def test_a_hand_that_moves_is_looked_at_five_times_a_second_once_it_has_left() -> None:
    moving = [holding(1.2, across=0.06 * number) for number in range(60)]
    held = 12  # frames until it counts as moving
    assert count_looks(moving[:held]) == pytest.approx(6, abs=1)
    assert count_looks(moving) == pytest.approx(6 + (60 - held) / 5, abs=2)


def test_a_hand_that_comes_to_rest_is_looked_at_in_the_next_frame() -> None:
    paces = ArmPaces()
    path = [0.06 * number for number in range(30)] + [1.74] * 3
    for number, across in enumerate(path):
        (pace,) = paces.update([(holding(1.2, across), "right")], number / 25)
        if number == 29:
            pace.read = number / 25
    assert pace.is_due(len(path) / 25)


def test_a_camera_of_a_few_frames_a_second_has_each_of_them_looked_at() -> None:
    assert count_looks([holding(1.2)] * 20, rate=8.0) == 20


def test_a_slow_machine_looks_at_hands_that_hang_once_a_second() -> None:
    assert count_looks([holding(1.2)] * 40, rate=5.0, spares=True) == 40
    assert count_looks([holding(-0.3)] * 40, rate=5.0, spares=True) == pytest.approx(8, abs=1)


def test_a_hand_that_was_lost_is_sought_at_once_and_then_less_often() -> None:
    (pace,) = ArmPaces().update([(holding(1.2), "right")], 0.0)
    due = []
    for number in range(1, 11):
        due.append(pace.is_due(number / 25))
        if due[-1]:
            pace.read, pace.misses = number / 25, pace.misses + 1
    assert due[: MOST_MISSES + 1] == [True] * (MOST_MISSES + 1)
    assert due[MOST_MISSES + 1 :].count(True) <= 2


def test_arms_of_several_people_keep_their_pace_whatever_their_order() -> None:
    paces = ArmPaces()
    near, far = holding(1.2), holding(1.2, across=3.0)
    first, second = paces.update([(near, "right"), (far, "right")], 0.0)
    assert paces.update([(far, "right"), (near, "right")], 0.04) == [second, first]
    assert paces.update([(near, "right")], 0.0)[0] not in (first, second)  # another clip


def hand_at(x: float, y: float) -> Hand:
    return Hand(flat_hand(size=60) + (x, y), "right", 0.9)


def test_a_wrist_goes_over_to_its_hand_and_comes_back_without_a_jump() -> None:
    pace = ArmPace("right", np.array([100.0, 100.0]))
    pace.steer(None, 0.04, parted=False)
    ways = []
    for parted in (True, False):
        steps = []
        for _ in range(10):
            pace.steer(hand_at(300, 100), 0.04, parted=parted)
            steps.append(pace.steered)
        ways.append(np.array(steps))
    wrist = hand_at(300, 100).xy[0]
    assert ways[0][-1] == pytest.approx(wrist)
    assert ways[1][-1] == pytest.approx(pace.wrist)
    steps = np.linalg.norm(np.diff(np.concatenate(ways), axis=0), axis=1)
    assert steps.max() <= np.linalg.norm(wrist - pace.wrist) * 0.04 / STEER_SECONDS + 1e-9


def test_in_the_first_frame_a_wrist_is_at_its_hand_at_once() -> None:
    pace = ArmPace("right", np.array([100.0, 100.0]))
    pace.steer(hand_at(300, 100), np.inf, parted=True)
    assert pace.steered == pytest.approx(hand_at(300, 100).xy[0])


def test_a_hand_that_is_lost_takes_its_wrist_along_for_a_moment_only() -> None:
    pace = ArmPace("right", np.array([100.0, 100.0]))
    pace.steer(hand_at(300, 100), np.inf, parted=True)
    for _ in range(10):
        pace.steer(None, 0.04, parted=False)
    assert pace.steered.tolist() == [100, 100]


def test_a_hand_away_from_all_arms_belongs_to_the_nearest_one_within_reach() -> None:
    xy = np.zeros((len(POSE_LANDMARKS), 2))
    for name, place in (
        ("left_shoulder", (150, 100)),
        ("right_shoulder", (50, 100)),
        ("left_hip", (150, 200)),
        ("right_hip", (50, 200)),
        ("left_wrist", (180, 200)),
        ("right_wrist", (20, 200)),
    ):
        xy[POSE_LANDMARKS.index(name)] = place
    body = Body(xy, np.ones(len(POSE_LANDMARKS)), 1.0)
    arms = [(body, side) for side in SIDES]
    near, far = hand_at(300, 200), hand_at(180 + (FAR + 1) * measure_body(body), 200)
    assert find_far_arm(near, arms) == SIDES.index("left")
    assert find_far_arm(far, arms) is None
    assert find_far_arm(near, []) is None
