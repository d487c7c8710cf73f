"""The paper's pair of hand models: real inference on drawn hands, and the port's two defects."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.errors import EstimatorError, ModelError
from app.recognition.estimation.factory import create_estimator
from app.recognition.estimation.landmark_models.diver_hands import DiverHands, find_peaks
from app.recognition.poses.frame import Body, Hand, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.salute import ENTER_SCORE, best_salute
from tests.recognition.estimation.marker_models import (
    HAND_COLOURS,
    draw_markers,
    save_hand_detector,
    save_hand_keypoints,
    save_yolo_pose,
)
from tests.recognition.parametric_hand import SHAPES, hand_xy, salute


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return the files of a hand detector and of a keypoint classifier."""
    folder = tmp_path_factory.mktemp("hands")
    return save_hand_detector(folder / "hand.onnx"), save_hand_keypoints(folder / "keypoints.onnx")


@pytest.fixture(scope="module")
def model(pair: tuple[Path, Path]) -> DiverHands:
    """Return both in use."""
    return DiverHands(*pair)


def placed(hand: FloatArray, low: tuple[float, float], size: float) -> FloatArray:
    """Move a hand's box to a corner and scale its longer side to `size` pixels."""
    moved = hand - hand.min(axis=0)
    return np.asarray(moved / moved.max() * size + low)


def picture(places: FloatArray, size: tuple[int, int] = (640, 480)) -> Image:
    image = np.zeros((size[1], size[0], 3), np.uint8)
    draw_markers(image, places, HAND_COLOURS, 5)
    return image


def only(hands: tuple[Hand, ...]) -> Hand:
    (hand,) = hands
    return hand


@pytest.mark.parametrize("size", [(640, 480), (480, 854), (1280, 720)])
def test_keypoints_are_pixels_of_the_image(model: DiverHands, size: tuple[int, int]) -> None:
    places = placed(hand_xy(salute()), (150.0, 120.0), 200)
    hand = only(model.find(picture(places, size), ()))
    # A cell of the heat map is 200 / 48, about four pixels, and a peak is known to a quarter of it.
    assert np.abs(hand.xy - places).max() < 2
    assert 0.5 < hand.score <= 1


def test_a_salute_is_seen_and_an_open_hand_is_none(model: DiverHands) -> None:
    for shape, saluting in ((salute(), True), (SHAPES["open"](np.random.default_rng(0)), False)):
        hands = model.find(picture(placed(hand_xy(shape), (200.0, 100.0), 220)), ())
        assert (best_salute(hands) > ENTER_SCORE) == saluting


def test_a_hand_at_the_edge_is_padded_where_the_port_cuts_out_nothing(model: DiverHands) -> None:
    places = placed(hand_xy(salute()), (-40.0, -30.0), 200)
    hand = only(model.find(picture(places), ()))
    inside = (places > 4).all(axis=1)
    assert 0 < inside.sum() < len(places)
    assert np.abs(hand.xy - places)[inside].max() < 3


def test_in_an_empty_picture_there_is_no_hand(model: DiverHands) -> None:
    model.reset()
    assert model.find(np.zeros((480, 640, 3), np.uint8), ()) == ()


def test_the_side_is_that_of_the_nearer_wrist(model: DiverHands) -> None:
    places = placed(hand_xy(salute()), (150.0, 120.0), 200)
    xy = np.full((33, 2), np.nan)
    image = picture(places)
    body = Body(xy, np.zeros(33), 1.0)
    assert only(model.find(image, (body,))).side == "right"
    xy[POSE_LANDMARKS.index("left_wrist")] = places[0]
    assert only(model.find(image, (body,))).side == "left"
    xy[POSE_LANDMARKS.index("right_wrist")] = places[0] + 30
    assert only(model.find(image, (body,))).side == "left"


@given(st.integers(0, 2**32 - 1))
def test_a_peak_lies_within_a_quarter_of_the_highest_cell(seed: int) -> None:
    maps = np.random.default_rng(seed).random((21, 6, 9)).astype(np.float32)
    for place, heat in zip(find_peaks(maps), maps, strict=True):
        row, column = np.unravel_index(heat.argmax(), heat.shape)
        assert np.abs(place - (column, row)).max() <= 0.25


def test_files_in_each_other_s_place_are_told_by_their_shapes(
    pair: tuple[Path, Path], tmp_path: Path
) -> None:
    detector, keypoints = pair
    with pytest.raises(ModelError, match=r"gives \[\(1, 19\).*needed: \(hands, 7\)"):
        DiverHands(keypoints, detector)
    with pytest.raises(ModelError, match=r"needed: \(1, 21, rows, columns\)"):
        DiverHands(detector, save_yolo_pose(tmp_path / "body.onnx", side=320))


@pytest.mark.usefixtures("installed_models")
def test_they_stand_beside_the_installed_body_too(pair: tuple[Path, Path]) -> None:
    estimator = create_estimator(hands=f"{pair[0]},{pair[1]}")
    places = placed(hand_xy(salute()), (150.0, 120.0), 200)
    found = estimator.estimate(picture(places), 0.0)
    assert best_salute(found.hands) > ENTER_SCORE
    estimator.reset()
    estimator.close()


@pytest.mark.parametrize("hands", ["openpose", "detector.onnx", ",keypoints.onnx"])
def test_other_hands_are_refused_with_the_ones_there_are(hands: str) -> None:
    with pytest.raises(EstimatorError, match=r"there are: mediapipe, none, .*KEYPOINTS\.onnx"):
        create_estimator(hands=hands)
