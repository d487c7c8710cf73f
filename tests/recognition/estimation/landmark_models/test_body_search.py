"""The search for a person: turned and dim ones are found, nobody is where nobody is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.recognition.estimation.factory import OnnxPoseEstimator
from app.recognition.estimation.landmark_models.body_model import (
    MARGIN,
    POSE_SIGNATURE,
    TORSO,
    BodyModel,
    BodySearch,
)
from app.recognition.estimation.landmark_models.detector import PERSON_LAYOUT, Detector
from app.recognition.estimation.landmark_models.onnx_session import ModelSession
from app.recognition.models.storage import model_path
from app.recognition.poses.frame import Image
from app.recognition.poses.landmarks import POSE_LANDMARKS
from benchmarks.accuracy.murky_clips import degrade
from tests.recognition.estimation.clip_frames import clip_frames

NOSE, HIP = POSE_LANDMARKS.index("nose"), POSE_LANDMARKS.index("left_hip")


@pytest.fixture(scope="module")
def diver(sample_clips: Path) -> Image:
    """Return a frame of a rendered diver, upright."""
    return next(clip_frames(sample_clips / "circle-demonstration.mp4", 1)).image


@pytest.fixture(scope="module")
def search(installed_models: None) -> BodySearch:
    """Return a search without the detection that precedes it."""
    persons = ModelSession(
        model_path("pose_detection"), PERSON_LAYOUT.signature, threads=1, provider="cpu"
    )
    bodies = ModelSession(
        model_path("pose_landmark_full"), POSE_SIGNATURE, threads=1, provider="cpu"
    )
    return BodySearch(Detector(persons, PERSON_LAYOUT), BodyModel(bodies))


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_a_diver_who_is_turned_is_found(
    estimator: OnnxPoseEstimator, diver: Image, quarters: int
) -> None:
    upright = estimator.examine(diver).body
    turned = estimator.examine(np.ascontiguousarray(np.rot90(diver, quarters))).body
    assert upright is not None
    assert turned is not None
    towards = upright.xy[NOSE] - upright.xy[HIP]
    for _ in range(quarters):
        towards = np.array([towards[1], -towards[0]])
    shown = turned.xy[NOSE] - turned.xy[HIP]
    assert shown @ towards > 0.8 * np.linalg.norm(shown) * np.linalg.norm(towards)


def test_a_diver_in_murk_is_found_as_filmed(estimator: OnnxPoseEstimator, diver: Image) -> None:
    (murky,) = degrade([diver], 0.8)
    clear, dim = estimator.examine(diver).body, estimator.examine(murky).body
    assert clear is not None
    assert dim is not None
    torso = np.linalg.norm(clear.xy[NOSE] - clear.xy[HIP])
    assert np.linalg.norm(dim.xy[NOSE] - clear.xy[NOSE]) < torso / 4


def test_nobody_is_found_in_noise(estimator: OnnxPoseEstimator) -> None:
    noise = np.random.default_rng(1).integers(0, 256, (360, 640, 3), dtype=np.uint8)
    assert estimator.examine(noise).body is None
    assert estimator.examine(np.full((360, 640, 3), 90, np.uint8)).body is None


@pytest.mark.parametrize("quarters", range(4))
def test_nobody_searched_is_cut_or_larger_than_the_image(
    search: BodySearch, estimator: OnnxPoseEstimator, diver: Image, quarters: int
) -> None:
    body = estimator.examine(diver).body
    assert body is not None
    (left, top), (right, bottom) = body.xy[TORSO].min(axis=0), body.xy[TORSO].max(axis=0)
    half = diver[:, : int((left + right) / 2)]
    near = diver[int(top) - 60 : int(bottom) + 10, int(left) - 80 : int(right) + 80]
    for part in (half, near):
        image = np.ascontiguousarray(np.rot90(part, quarters))
        found = search.find(image)
        if found is not None:
            height, width = image.shape[:2]
            assert (found.xy[TORSO] >= 0).all()
            assert (found.xy[TORSO] < (width, height)).all()
            assert found.following.side <= MARGIN * max(width, height)
