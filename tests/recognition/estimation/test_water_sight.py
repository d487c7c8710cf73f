"""Sight through water: the best correction for the models; clear images stay unchanged."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from app.recognition.errors import EstimatorError
from app.recognition.estimation.factory import (
    ComposedEstimator,
    OnnxPoseEstimator,
    TrackedHands,
    body_tracker,
    hand_tracker,
)
from app.recognition.estimation.water import WaterSight, is_murky
from app.recognition.poses.frame import FrameLandmarks, Image
from app.recognition.poses.landmarks import POSE_LANDMARKS
from app.recognition.recording.video import VideoFrame
from benchmarks.accuracy.murky_clips import degrade
from tests.recognition.estimation.clip_frames import clip_frames


@pytest.fixture(scope="module")
def frames(sample_clips: Path) -> tuple[VideoFrame, ...]:
    return tuple(clip_frames(sample_clips / "circle-demonstration.mp4", 4))


def assert_equal(one: FrameLandmarks, other: FrameLandmarks) -> None:
    assert one.body is not None
    assert other.body is not None
    np.testing.assert_array_equal(one.body.xy, other.body.xy)
    assert len(one.hands) == len(other.hands)
    for hand, same in zip(one.hands, other.hands, strict=True):
        np.testing.assert_array_equal(hand.xy, same.xy)


def murky_with_lamp(image: Image) -> Image:
    """Return a frame in murk with a lamp at its edge, so that its grey levels look clear."""
    (murky,) = degrade([image], 0.75)
    murky[: len(murky) // 12] = 255
    return murky


def look(
    estimator: OnnxPoseEstimator, frames: tuple[VideoFrame, ...], water: Any
) -> list[FrameLandmarks]:
    sight = WaterSight(estimator, water)
    sight.reset()
    return [sight.estimate(frame.image, frame.time) for frame in frames]


def test_clear_frames_are_seen_as_they_are(
    estimator: OnnxPoseEstimator, frames: tuple[VideoFrame, ...]
) -> None:
    for one, other in zip(
        look(estimator, frames, "auto"), look(estimator, frames, "off"), strict=True
    ):
        assert_equal(one, other)


def test_in_murk_auto_finds_hands_that_nothing_is_found_of_as_filmed(
    estimator: OnnxPoseEstimator, frames: tuple[VideoFrame, ...]
) -> None:
    (image,) = degrade([frames[0].image], 0.75)
    murky = (VideoFrame(index=0, time=0.0, image=image),)
    (as_filmed,) = look(estimator, murky, "off")
    (found,) = look(estimator, murky, "auto")
    assert found.body is not None
    assert len(found.hands) > len(as_filmed.hands)


def test_an_examination_leaves_the_tracking_alone(
    estimator: OnnxPoseEstimator, frames: tuple[VideoFrame, ...]
) -> None:
    undisturbed = [estimator.estimate(frame.image, frame.time) for frame in frames]
    estimator.reset()
    for frame, expected in zip(frames, undisturbed, strict=True):
        found = estimator.estimate(frame.image, frame.time)
        estimator.examine(np.ascontiguousarray(frame.image[:, ::-1]))
        assert_equal(found, expected)


def test_an_unknown_setting_is_refused_before_any_frame(estimator: OnnxPoseEstimator) -> None:
    with pytest.raises(EstimatorError, match="'sea'; there are: auto, on, off"):
        WaterSight(estimator, cast(Any, "sea"))


def test_separate_models_for_bodies_and_hands_are_asked_too(
    installed_models: None, frames: tuple[VideoFrame, ...]
) -> None:
    image = murky_with_lamp(frames[0].image)
    assert not is_murky(image)
    hands = TrackedHands(hand_tracker(search="palm", threads=1, provider="cpu"))
    composed = ComposedEstimator(body_tracker(threads=1, provider="cpu"), hands, POSE_LANDMARKS)
    counts = [
        len(WaterSight(composed, water).estimate(image, 0.0).hands) for water in ("off", "auto")
    ]
    assert counts[1] > counts[0]
