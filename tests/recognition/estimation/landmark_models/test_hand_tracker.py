"""Hands: when two are one, and which are found on the arms of a body."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.estimation.factory import OnnxPoseEstimator, hand_tracker
from app.recognition.estimation.landmark_models.arms import wrist_distance
from app.recognition.estimation.landmark_models.hand_model import (
    HandPlace,
    SeenHand,
    find_duplicates,
)
from app.recognition.estimation.landmark_models.region import KNUCKLES, WRIST, region_of_hand
from app.recognition.poses.frame import SIDES, Body, FrameLandmarks, Hand, Image, Side
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.salute import ENTER_SCORE, best_salute, salute_score
from app.recognition.recording.video import VideoFrame
from tests.recognition.estimation.clip_frames import clip_frames
from tests.recognition.estimation.drawn_hand import flat_hand, turned

ANGLES = st.floats(-math.pi, math.pi)
SHIFTS = st.tuples(st.floats(-300, 300), st.floats(-300, 300)).map(np.array)

SALUTING = slice(22, 30)
"""Frames of the first demonstration in which the start salute is held."""

FAR_AWAY = 0.5
"""Factor that shrinks the demonstrations, filmed from 2.3 m, to their size at 4.6 m."""


def hand(xy: FloatArray) -> Hand:
    return Hand(xy, "right", 1.0)


def test_the_same_hand_found_twice_is_one() -> None:
    assert find_duplicates(hand(flat_hand()), hand(flat_hand() + 3))


def test_two_hands_side_by_side_are_two() -> None:
    assert not find_duplicates(hand(flat_hand()), hand(flat_hand() + (110, 0)))


def test_crossed_hands_that_overlap_are_two() -> None:
    assert not find_duplicates(hand(flat_hand()), hand(turned(flat_hand(), math.pi / 2)))


@given(ANGLES, SHIFTS, st.floats(0.3, 3))
def test_being_the_same_hand_is_mutual(angle: float, shift: FloatArray, size: float) -> None:
    one, other = hand(flat_hand()), hand(turned(flat_hand(size=100 * size), angle) + shift)
    assert find_duplicates(one, other) == find_duplicates(other, one)


@pytest.fixture(scope="module")
def saluting(sample_clips: Path) -> tuple[VideoFrame, ...]:
    """Return frames of a rendered diver who salutes."""
    return tuple(clip_frames(sample_clips / "circle-demonstration.mp4", 30))[SALUTING]


def far_away(image: Image) -> Image:
    """Surround a diver with more of the same water."""
    small = cv2.resize(image, None, fx=FAR_AWAY, fy=FAR_AWAY, interpolation=cv2.INTER_AREA)
    rows, columns = (
        (whole - part) // 2 for whole, part in zip(image.shape, small.shape[:2], strict=False)
    )
    edges = (rows, rows, columns, columns)
    return np.asarray(cv2.copyMakeBorder(small, *edges, cv2.BORDER_REPLICATE), np.uint8)


def without_hands(image: Image, found: FrameLandmarks) -> Image:
    """Paint the surroundings over the ends of a body's arms."""
    assert found.body is not None
    mask = np.zeros(image.shape[:2], np.uint8)
    for side in SIDES:
        wrist, index = (
            found.body.xy[POSE_LANDMARKS.index(f"{side}_{part}")] for part in ("wrist", "index")
        )
        middle, reach = (wrist + index) / 2, 2.5 * float(np.linalg.norm(index - wrist))
        cv2.circle(mask, (round(middle[0]), round(middle[1])), round(reach), 255, cv2.FILLED)
    return np.asarray(cv2.inpaint(image, mask, 5, cv2.INPAINT_TELEA), np.uint8)


def test_a_distant_diver_s_salute_is_seen(
    estimator: OnnxPoseEstimator, saluting: tuple[VideoFrame, ...]
) -> None:
    scores = [
        best_salute(estimator.estimate(far_away(frame.image), frame.time).hands)
        for frame in saluting
    ]
    assert np.mean(np.array(scores) > ENTER_SCORE) > 0.7


@pytest.mark.slow
def test_arms_whose_hands_are_hidden_get_none(
    estimator: OnnxPoseEstimator, saluting: tuple[VideoFrame, ...]
) -> None:
    hidden = [
        without_hands(frame.image, estimator.estimate(frame.image, frame.time))
        for frame in saluting
    ]
    estimator.reset()
    results = [estimator.estimate(image, index / 25) for index, image in enumerate(hidden)]
    assert all(result.body is not None for result in results)
    assert [result.hands for result in results] == [()] * len(hidden)


def test_a_hand_never_loses_its_place_to_one_believed_less(installed_models: None) -> None:
    """Two phantoms at the arms of a phantom body, and a true hand away from them."""
    xy: FloatArray = np.full((len(POSE_LANDMARKS), 2), np.nan)
    phantoms = {"left": flat_hand(size=15) + (100, 100), "right": flat_hand(size=15) + (200, 100)}
    for side, phantom in phantoms.items():
        xy[POSE_LANDMARKS.index(f"{side}_wrist")] = phantom[0]
    body = Body(xy, np.ones(len(POSE_LANDMARKS)), 0.6)
    true = Hand(flat_hand() + (400, 300), "left", 0.99)
    followed = tuple(
        SeenHand(one, region_of_hand(one.xy))
        for one in (*(Hand(xy, "left", 0.6) for xy in phantoms.values()), true)
    )
    tracker = hand_tracker(search="pose", threads=1, provider="cpu")
    kept = tracker.complete(np.zeros((480, 640, 3), np.uint8), followed, (body,)).hands
    assert kept[0] is true
    assert len(kept) == 2


def test_of_two_hands_at_one_arm_the_one_believed_more_is_kept(installed_models: None) -> None:
    xy: FloatArray = np.full((len(POSE_LANDMARKS), 2), np.nan)
    xy[POSE_LANDMARKS.index("left_wrist")] = 300, 300
    body = Body(xy, np.ones(len(POSE_LANDMARKS)), 0.9)
    nearer = Hand(flat_hand() + (300, 300), "left", 0.6)
    surer = Hand(turned(flat_hand(), 1.0) + (330, 300), "left", 0.9)
    followed = tuple(SeenHand(one, region_of_hand(one.xy)) for one in (nearer, surer))
    tracker = hand_tracker(search="pose", threads=1, provider="cpu")
    kept = tracker.complete(np.zeros((480, 640, 3), np.uint8), followed, (body,))
    assert kept.hands == (surer,)


def test_fingers_are_looked_for_at_an_arm_of_whose_hand_only_the_place_is_seen(
    estimator: OnnxPoseEstimator, saluting: tuple[VideoFrame, ...]
) -> None:
    image = saluting[-1].image
    found = estimator.estimate(image, 0.0)
    assert found.body is not None
    saluter = max(found.hands, key=lambda one: salute_score(one.xy))
    box = replace(region_of_hand(saluter.xy), side=saluter.size)
    palm = np.full_like(saluter.xy, np.nan)
    palm[[WRIST, *KNUCKLES]] = saluter.xy[[WRIST, *KNUCKLES]]
    place = HandPlace(replace(saluter, xy=palm), box)
    tracker = hand_tracker(search="pose", threads=1, provider="cpu")
    seen = tracker.complete(image, (SeenHand.at(place),), (found.body,))
    assert best_salute(seen.hands) > ENTER_SCORE
    assert seen.places == ()


@pytest.mark.parametrize(
    ("least", "judged", "stays"), [(0.0, True, True), (np.inf, True, False), (np.inf, False, True)]
)
def test_a_hand_stays_with_the_word_of_two_of_its_first_three_frames(
    estimator: OnnxPoseEstimator,
    saluting: tuple[VideoFrame, ...],
    monkeypatch: pytest.MonkeyPatch,
    least: float,
    judged: bool,
    stays: bool,
) -> None:
    image = saluting[-1].image
    found = estimator.estimate(image, 0.0)
    assert found.body is not None
    saluter = max(found.hands, key=lambda one: salute_score(one.xy))
    for name in ("BELIEVED", "SURE"):
        monkeypatch.setattr(f"app.recognition.estimation.landmark_models.hand_model.{name}", least)
    if not judged:
        monkeypatch.setattr("app.recognition.estimation.factory.gloves_path", lambda: None)
    tracker = hand_tracker(search="pose", threads=1, provider="cpu")
    seen: tuple[SeenHand, ...] = (SeenHand(saluter, region_of_hand(saluter.xy)),)
    stayed = []
    for time in (0.0, 1.0):
        tracker.complete(image, seen, (found.body,), time)
        seen = tracker.follow(image, time + 1.0)
        stayed.append(any(find_duplicates(one.hand, saluter) for one in seen))
    assert stayed == [True, stays]


def test_no_arm_has_two_hands(
    estimator: OnnxPoseEstimator, saluting: tuple[VideoFrame, ...]
) -> None:
    pairs = []
    for frame in saluting:
        found = estimator.estimate(frame.image, frame.time)
        if found.body is not None and len(found.hands) == 2:
            pairs.append({_nearest_arm(one, found.body) for one in found.hands})
    assert pairs
    assert all(len(arms) == 2 for arms in pairs)


def _nearest_arm(one: Hand, body: Body) -> Side:
    return min(SIDES, key=lambda side: wrist_distance(one, body, side))


@pytest.mark.slow
def test_a_real_diver_s_gloved_hand_is_found(
    estimator: OnnxPoseEstimator, shared_data: Path
) -> None:
    """The palm detector alone finds it in 15 of 83 frames."""
    frames = clip_frames(shared_data / "clips" / "diver_follow_me.webm", 83)
    found = [len(estimator.estimate(frame.image, frame.time).hands) for frame in frames]
    assert np.mean(np.array(found) > 0) > 0.9
    assert max(found) == 1, "the other hand is hidden in all frames"
