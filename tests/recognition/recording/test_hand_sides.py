"""Hand sides: left and right hands are told apart by the wrists of the body."""

import numpy as np
import pytest

from app.recognition.poses.frame import Hand, Side
from app.recognition.recording.recording import place_hands
from tests.recognition.parametric_hand import hand_xy, salute

LEFT, RIGHT = (400.0, 200.0), (200.0, 200.0)
WRISTS = np.array([[LEFT, RIGHT]])


def hand(at: tuple[float, float], side: Side, score: float = 0.9) -> Hand:
    points = 40 * hand_xy(salute())
    return Hand(points - points[0] + at, side, score)


@pytest.mark.parametrize("believed", ["left", "right"])
def test_a_hand_belongs_to_the_nearest_wrist_whatever_the_model_believes(believed: Side) -> None:
    placed = place_hands([[hand((210, 205), believed)]], WRISTS)
    assert placed is not None
    assert np.isnan(placed[0, 0]).all()
    assert np.allclose(placed[0, 1, 0], (210, 205))


def test_two_hands_are_paired_with_both_wrists() -> None:
    near_left, also_near_left = hand((390, 200), "right"), hand((330, 200), "right")
    placed = place_hands([[near_left, also_near_left]], WRISTS)
    assert placed is not None
    assert np.allclose(placed[0, :, 0], [(390, 200), (330, 200)])


def test_without_wrists_the_models_own_side_counts_for_the_surer_hand() -> None:
    sure, unsure = hand((10, 10), "left", 0.9), hand((90, 90), "left", 0.6)
    placed = place_hands([[unsure, sure]], np.full((1, 2, 2), np.nan))
    assert placed is not None
    assert np.allclose(placed[0, 0, 0], (10, 10))
    assert np.isnan(placed[0, 1]).all()


def test_no_hand_in_any_frame_is_none() -> None:
    assert place_hands([[], []], np.repeat(WRISTS, 2, axis=0)) is None
