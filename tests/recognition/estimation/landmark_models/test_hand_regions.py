"""The regions that whole hands are looked for in."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.landmark_models.region import (
    PALM_TURN,
    Detection,
    region_of_hand,
    region_of_palm,
)
from app.recognition.poses.sequence import FloatArray
from tests.recognition.estimation.drawn_hand import flat_hand, turned
from tests.recognition.estimation.landmark_models.crops import to_crop

ANGLES = st.floats(-math.pi, math.pi)
SHIFTS = st.tuples(st.floats(-300, 300), st.floats(-300, 300)).map(np.array)

WRIST, MIDDLE_TIP = 0, 12


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
    shown = to_crop(region_of_hand(xy), xy, 224)
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
