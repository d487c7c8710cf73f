"""The body's tracker: the detector first, a search where it has found nobody for a while."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.recognition.estimation.factory import OnnxPoseEstimator
from app.recognition.estimation.landmark_models.body import SEARCH_PAUSE, STILL_SECONDS
from app.recognition.estimation.landmark_models.body_model import BodyModel, SeenBody
from app.recognition.estimation.landmark_models.region import Region
from app.recognition.poses.frame import Image
from tests.recognition.estimation.clip_frames import clip_frames


@pytest.fixture(scope="module")
def upright(sample_clips: Path) -> Image:
    return next(clip_frames(sample_clips / "circle-demonstration.mp4", 1)).image


def found(estimator: OnnxPoseEstimator, images: list[Image]) -> list[bool]:
    return [
        estimator.estimate(image, index / 25).body is not None for index, image in enumerate(images)
    ]


def test_the_first_frame_is_searched_at_once_and_who_is_found_is_followed(
    estimator: OnnxPoseEstimator, upright: Image
) -> None:
    head_down = np.ascontiguousarray(np.rot90(upright, 2))
    assert found(estimator, [head_down] * 3) == [True] * 3


def test_who_only_a_search_finds_is_found_after_a_pause(
    estimator: OnnxPoseEstimator, upright: Image
) -> None:
    nobody = np.full_like(upright, 90)
    head_down = np.ascontiguousarray(np.rot90(upright, 2))
    seen = found(estimator, [nobody, *[head_down] * (SEARCH_PAUSE + 1)])
    assert seen == [*[False] * SEARCH_PAUSE, True, True]


def test_frames_with_somebody_start_the_pause_anew(
    estimator: OnnxPoseEstimator, upright: Image
) -> None:
    nobody = np.full_like(upright, 90)
    head_down = np.ascontiguousarray(np.rot90(upright, 2))
    some = [nobody] * (SEARCH_PAUSE - 2)
    seen = found(estimator, [*some, upright, nobody, head_down])
    assert seen == [*[False] * len(some), True, False, False]


def test_who_keeps_still_is_looked_at_in_every_second_frame_with_the_same_result(
    estimator: OnnxPoseEstimator, upright: Image, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks = 0
    original = BodyModel.look

    def look(model: BodyModel, image: Image, region: Region) -> SeenBody:
        nonlocal looks
        looks += 1
        return original(model, image, region)

    monkeypatch.setattr(BodyModel, "look", look)
    places = []
    for number in range(40):
        body = estimator.estimate(upright, number / 25).body
        assert body is not None
        places.append(body.xy)
    settled = round(STILL_SECONDS * 25) + 3
    assert looks <= settled + (40 - settled) / 2 + 5  # and some of the search for further people
    moved = np.linalg.norm(places[-1] - places[settled], axis=1)
    assert np.median(moved) < 0.01 * upright.shape[0]


def test_a_single_image_is_searched_at_once(estimator: OnnxPoseEstimator, upright: Image) -> None:
    assert estimator.examine(np.ascontiguousarray(np.rot90(upright, 2))).body is not None
