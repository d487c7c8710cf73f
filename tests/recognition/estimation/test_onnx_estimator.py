"""The default estimator: any image, any strides, tracking, and what it finds on real frames."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.recognition.errors import EstimatorError
from app.recognition.estimation.factory import OnnxPoseEstimator
from app.recognition.poses.frame import FrameLandmarks, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.recording.video import VideoFrame
from tests.recognition.estimation.clip_frames import clip_frames

LEFT_WRIST, RIGHT_WRIST = POSE_LANDMARKS.index("left_wrist"), POSE_LANDMARKS.index("right_wrist")


@pytest.fixture(scope="module")
def signing(shared_data: Path) -> tuple[VideoFrame, ...]:
    """Return frames of a person who faces the camera and signs with both hands."""
    clip = shared_data / "clips" / "slt_person205_front.mp4"
    return tuple(clip_frames(clip, 8, every=7))


def same(one: FrameLandmarks, other: FrameLandmarks) -> bool:
    """Return whether two results agree in every number."""
    if (one.body is None) != (other.body is None) or len(one.hands) != len(other.hands):
        return False
    bodies = one.body is None or (other.body is not None and (one.body.xy == other.body.xy).all())
    hands = zip(one.hands, other.hands, strict=True)
    return bool(bodies) and all((mine.xy == theirs.xy).all() for mine, theirs in hands)


@pytest.mark.parametrize(
    "size", [(1, 1), (1, 300), (300, 1), (2, 3), (33, 17), (127, 255), (481, 641)]
)
def test_any_size_of_an_empty_image_shows_nobody(
    estimator: OnnxPoseEstimator, size: tuple[int, int]
) -> None:
    image = np.full((*size, 3), 120, np.uint8)
    result = estimator.estimate(image, 0.0)
    assert result.body is None
    assert result.hands == ()


@pytest.mark.parametrize(
    "image",
    [
        np.zeros((4, 4), np.uint8),
        np.zeros((4, 4, 4), np.uint8),
        np.zeros((0, 4, 3), np.uint8),
        np.zeros((4, 4, 3), np.float32),
        np.zeros((2, 20000, 3), np.uint8),
    ],
)
def test_what_is_no_rgb_image_is_refused_with_what_was_seen(
    estimator: OnnxPoseEstimator, image: Image
) -> None:
    with pytest.raises(EstimatorError, match=r"image has shape \(.*expected \(height, width, 3\)"):
        estimator.estimate(image, 0.0)


def test_a_person_and_hands_are_found(
    estimator: OnnxPoseEstimator, signing: tuple[VideoFrame, ...]
) -> None:
    results = [estimator.estimate(frame.image, frame.time) for frame in signing]
    bodies = [result.body for result in results if result.body is not None]
    assert len(bodies) == len(signing)
    for body in bodies:
        assert body.xy.shape == (33, 2)
        assert ((body.visibility >= 0) & (body.visibility <= 1)).all()
        assert 0.5 <= body.score <= 1
    hands = [hand for result in results for hand in result.hands]
    assert len(hands) > len(signing) / 2
    for hand in hands:
        assert hand.xy.shape == (21, 2)
        assert 0.5 <= hand.score <= 1


def test_a_hand_s_side_is_the_person_s_own(
    estimator: OnnxPoseEstimator, signing: tuple[VideoFrame, ...]
) -> None:
    """A hand labelled right by the hand model is at the wrist labelled right by the pose model."""
    agreements = []
    for frame in signing:
        result = estimator.estimate(frame.image, frame.time)
        assert result.body is not None
        wrists = result.body.xy[[LEFT_WRIST, RIGHT_WRIST]]
        for hand in result.hands:
            nearer = np.linalg.norm(wrists - hand.xy[0], axis=1).argmin()
            agreements.append(hand.side == ("left", "right")[nearer])
    assert np.mean(agreements) > 0.8


def test_larger_hands_come_first(
    estimator: OnnxPoseEstimator, signing: tuple[VideoFrame, ...]
) -> None:
    pairs = 0
    for frame in signing:
        sizes = [hand.size for hand in estimator.estimate(frame.image, frame.time).hands]
        assert sizes == sorted(sizes, reverse=True)
        pairs += len(sizes) == 2
    assert pairs


def test_after_reset_a_clip_gives_what_it_gave_at_first(
    estimator: OnnxPoseEstimator, signing: tuple[VideoFrame, ...]
) -> None:
    first = [estimator.estimate(frame.image, frame.time) for frame in signing[:4]]
    estimator.reset()
    again = [estimator.estimate(frame.image, frame.time) for frame in signing[:4]]
    assert all(map(same, first, again))


def test_without_reset_the_tracked_past_shows(
    estimator: OnnxPoseEstimator, signing: tuple[VideoFrame, ...]
) -> None:
    first = estimator.estimate(signing[0].image, signing[0].time)
    for frame in signing[1:4]:
        estimator.estimate(frame.image, frame.time)
    assert not same(first, estimator.estimate(signing[0].image, signing[4].time))


def test_two_threads_give_the_same_as_one(
    estimator: OnnxPoseEstimator, signing: tuple[VideoFrame, ...]
) -> None:
    parallel = OnnxPoseEstimator(threads=2)
    for frame in signing[:4]:
        one = estimator.estimate(frame.image, frame.time)
        assert same(one, parallel.estimate(frame.image, frame.time))
    parallel.close()


def test_the_image_is_not_written_to(
    estimator: OnnxPoseEstimator, signing: tuple[VideoFrame, ...]
) -> None:
    image = signing[0].image.copy()
    image.setflags(write=False)
    estimator.estimate(image, 0.0)
    np.testing.assert_array_equal(image, signing[0].image)


@pytest.mark.parametrize("second", [1.0, 0.5, -7.0])
def test_a_time_that_does_not_increase_does_no_harm(
    estimator: OnnxPoseEstimator, signing: tuple[VideoFrame, ...], second: float
) -> None:
    estimator.estimate(signing[0].image, 1.0)
    result = estimator.estimate(signing[0].image, second)
    assert result.body is not None
    assert np.isfinite(result.body.xy).all()


def test_who_leaves_is_gone_and_who_returns_is_found(
    estimator: OnnxPoseEstimator, signing: tuple[VideoFrame, ...]
) -> None:
    person = signing[0].image
    nobody = np.full_like(person, 90)
    seen = [
        estimator.estimate(image, index / 30).body is not None
        for index, image in enumerate([person, person, nobody, nobody, person])
    ]
    assert seen == [True, True, False, False, True]
