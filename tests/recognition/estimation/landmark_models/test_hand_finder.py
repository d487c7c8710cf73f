"""The finder of divers' hands, on a rendered diver that it was not taught on (seed 6003)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from app.recognition.estimation.factory import OnnxPoseEstimator, hand_tracker
from app.recognition.estimation.landmark_models.detector import PALM_LAYOUT, Detector
from app.recognition.estimation.landmark_models.hand_model import (
    LARGEST,
    HandFinder,
    HandPlace,
    parts_of,
)
from app.recognition.estimation.landmark_models.onnx_session import ModelSession
from app.recognition.estimation.landmark_models.region import Region
from app.recognition.estimation.water import WaterSight
from app.recognition.models.storage import finder_path
from app.recognition.poses.frame import Body, Hand, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS

PICTURE = Path(__file__).parents[1] / "gloved_diver.jpg"
HANDS = ((452, 344, 520, 390), (322, 154, 352, 193))
"""Left, top, right and bottom of its hands, pixels."""


@pytest.fixture(scope="module")
def diver() -> Image:
    image = cv2.imread(str(PICTURE))
    assert image is not None
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2RGB), np.uint8)


@pytest.fixture(scope="module")
def finder() -> HandFinder:
    path = finder_path()
    assert path is not None
    session = ModelSession(path, PALM_LAYOUT.signature, threads=1, provider="cpu")
    return HandFinder(Detector(session, PALM_LAYOUT))


@pytest.fixture(scope="module")
def gloved_sight(installed_models: None) -> Iterator[WaterSight]:
    with closing(OnnxPoseEstimator(threads=1)) as estimator:
        yield WaterSight(estimator)


def lies_in_a_hand(x: float, y: float) -> bool:
    return any(left <= x <= right and top <= y <= low for left, top, right, low in HANDS)


def test_a_gloved_hand_is_found_in_parts_of_a_picture(finder: HandFinder, diver: Image) -> None:
    best = finder.search(diver, parts_of(diver), 0.5)[0]
    assert lies_in_a_hand(best.box.x, best.box.y)
    assert np.isfinite(best.hand.xy).all(axis=1).sum() == 5


def test_a_place_is_found_again_near_where_it_was(finder: HandFinder, diver: Image) -> None:
    best = finder.search(diver, parts_of(diver), 0.5)[0]
    moved = replace(best.box, x=best.box.x + 0.3 * best.box.side)
    again = finder.look(diver, moved, 0.3)
    assert again is not None
    assert lies_in_a_hand(again.box.x, again.box.y)
    assert finder.look(diver, Region(60, 60, best.box.side), 0.5) is None


def test_plain_water_shows_no_hand(finder: HandFinder) -> None:
    water = np.full((360, 640, 3), (40, 90, 100), np.uint8)
    assert finder.search(water, parts_of(water), 0.5) == ()


def test_a_head_and_what_is_larger_than_a_body_are_no_hands() -> None:
    xy = np.zeros((len(POSE_LANDMARKS), 2))
    for name, place in (
        ("nose", (100, 50)),
        ("left_shoulder", (150, 100)),
        ("right_shoulder", (50, 100)),
        ("left_hip", (150, 200)),
        ("right_hip", (50, 200)),
    ):
        xy[POSE_LANDMARKS.index(name)] = place
    body = Body(xy, np.ones(len(POSE_LANDMARKS)), 1.0)
    hand = Hand(np.full((21, 2), np.nan), "right", 0.9)
    assert HandPlace(hand, Region(200, 180, 60)).fits(body)
    assert not HandPlace(hand, Region(105, 55, 60)).fits(body)
    assert not HandPlace(hand, Region(300, 180, 100 * (LARGEST + 0.1))).fits(body)


def test_fingers_of_gloved_hands_are_seen_and_followed(
    gloved_sight: WaterSight, diver: Image
) -> None:
    gloved_sight.reset()
    for time in (0.0, 0.04):
        found = gloved_sight.estimate(diver, time)
        assert len(found.hands) == 2
        assert all(lies_in_a_hand(*hand.xy.mean(axis=0)) for hand in found.hands)
        assert found.places == ()


def test_a_hand_is_believed_in_and_what_is_none_is_not(
    installed_models: None, finder: HandFinder, diver: Image
) -> None:
    model = hand_tracker(search="pose", threads=1, provider="cpu").model
    places = finder.search(diver, parts_of(diver), 0.1)
    hands = [place for place in places if lies_in_a_hand(place.box.x, place.box.y)]
    assert all(model.believes_place(diver, place) for place in hands[:2])
    others = [place for place in places if not lies_in_a_hand(place.box.x, place.box.y)]
    assert others
    assert not any(model.believes_place(diver, place) for place in others)


def test_without_the_model_of_gloved_hands_their_places_are_seen(
    installed_models: None, diver: Image, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.recognition.estimation.factory.gloves_path", lambda: None)
    with closing(OnnxPoseEstimator(threads=1)) as estimator:
        sight = WaterSight(estimator)
        found = sight.estimate(diver, 0.0)
        seen = [np.nanmean(hand.xy, axis=0) for hand in (*found.hands, *found.places)]
        assert len(seen) == 2
        assert all(lies_in_a_hand(x, y) for x, y in seen)
        followed = sight.estimate(diver, 0.04)
    assert len(followed.hands) + len(followed.places) == 2
