"""Hands: the regions they are looked for in, and when two are one."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.base import Hand
from app.recognition.estimation.hands import PALM_TURN, duplicates, region_of_hand, region_of_palm
from app.recognition.estimation.suppression import Detection
from app.recognition.poses import FloatArray

ANGLES = st.floats(-math.pi, math.pi)
SHIFTS = st.tuples(st.floats(-300, 300), st.floats(-300, 300)).map(np.array)

WRIST, MIDDLE_TIP = 0, 12


def flat_hand(*, size: float = 100.0) -> FloatArray:
    """Return an open hand, fingers up, wrist at the origin, from wrist to middle tip `size`."""
    fingers = [
        [(-0.25 + 0.17 * finger, -0.5 - 0.16 * joint) for joint in range(4)] for finger in range(4)
    ]
    thumb = [(-0.2 - 0.06 * joint, -0.15 - 0.1 * joint) for joint in range(4)]
    points = [(0.0, 0.0), *thumb, *(point for finger in fingers for point in finger)]
    return np.multiply(points, size, dtype=np.float64)


def turned(points: FloatArray, angle: float) -> FloatArray:
    """Turn points clockwise as seen on the screen."""
    cosine, sine = math.cos(angle), math.sin(angle)
    rotation: FloatArray = np.array([[cosine, sine], [-sine, cosine]])
    return np.asarray(points @ rotation, dtype=np.float64)


def hand(xy: FloatArray) -> Hand:
    return Hand(xy, "right", 1.0)


@given(ANGLES, SHIFTS)
def test_the_region_turns_and_moves_with_the_hand(angle: float, shift: FloatArray) -> None:
    upright, moved = region_of_hand(flat_hand()), region_of_hand(turned(flat_hand(), angle) + shift)
    assert math.isclose(moved.side, upright.side, rel_tol=1e-9)
    difference = moved.rotation - upright.rotation - angle
    assert math.isclose(math.cos(difference), 1, abs_tol=1e-9)
    centre = turned(np.array([[upright.x, upright.y]]), angle)[0] + shift
    np.testing.assert_allclose((moved.x, moved.y), centre, atol=1e-6)


@given(ANGLES, st.floats(10, 500))
def test_the_whole_hand_lies_upright_in_its_region(angle: float, size: float) -> None:
    xy = turned(flat_hand(size=size), angle)
    shown = region_of_hand(xy).to_crop(xy, 224)
    assert ((shown > 0) & (shown < 224)).all()
    assert shown[WRIST, 1] > shown[MIDDLE_TIP, 1]
    assert abs(shown[WRIST, 0] - shown[MIDDLE_TIP, 0]) < 40


@given(ANGLES)
def test_a_palm_s_region_lies_towards_the_fingers(angle: float) -> None:
    wrist, knuckle = turned(np.array([[0.0, 20.0], [0.0, -20.0]]), angle)
    keypoints = np.array([wrist, wrist, knuckle, wrist, wrist, wrist, wrist])
    region = region_of_palm(Detection(np.array([[-25.0, -25.0], [25.0, 25.0]]), keypoints, 0.9))
    assert math.isclose(region.side, 130)
    towards = turned(np.array([[0.0, -25.0]]), angle + PALM_TURN)[0]
    np.testing.assert_allclose((region.x, region.y), towards, atol=1e-9)


def test_the_same_hand_found_twice_is_one() -> None:
    assert duplicates(hand(flat_hand()), hand(flat_hand() + 3))


def test_two_hands_side_by_side_are_two() -> None:
    assert not duplicates(hand(flat_hand()), hand(flat_hand() + (110, 0)))


def test_crossed_hands_that_overlap_are_two() -> None:
    assert not duplicates(hand(flat_hand()), hand(turned(flat_hand(), math.pi / 2)))


@given(ANGLES, SHIFTS, st.floats(0.3, 3))
def test_being_the_same_hand_is_mutual(angle: float, shift: FloatArray, size: float) -> None:
    one, other = hand(flat_hand()), hand(turned(flat_hand(size=100 * size), angle) + shift)
    assert duplicates(one, other) == duplicates(other, one)
