"""What the tests of pose estimation share: estimators made of the installed models."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from app.recognition.errors import EstimatorError
from app.recognition.estimation.factory import OnnxPoseEstimator
from app.recognition.estimation.mediapipe_estimator import MediaPipeEstimator


@pytest.fixture(scope="session")
def loaded_estimator(installed_models: None) -> Iterator[OnnxPoseEstimator]:
    """Return the one estimator of the session, for loading takes longer than most tests."""
    estimator = OnnxPoseEstimator(threads=1)
    yield estimator
    estimator.close()


@pytest.fixture
def estimator(loaded_estimator: OnnxPoseEstimator) -> OnnxPoseEstimator:
    """Return an estimator after a reset."""
    loaded_estimator.reset()
    return loaded_estimator


@pytest.fixture(scope="session")
def library(installed_models: None) -> Iterator[MediaPipeEstimator]:
    """Return MediaPipe's own library; skip where it is not installed or does not start."""
    try:
        estimator = MediaPipeEstimator()
    except EstimatorError as error:
        pytest.skip(f"needs the extra `mediapipe`: {error}")
    yield estimator
    estimator.close()
