"""What the tests of pose estimation share: the installed models and estimators made of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import get_args

import pytest

from app.recognition.errors import EstimatorError, ModelError
from app.recognition.estimation import MediaPipeEstimator, OnnxPoseEstimator
from app.recognition.models import ModelName, model_path


@pytest.fixture(scope="session")
def installed_models() -> None:
    """Skip where the models are not installed; `make test` installs them first."""
    try:
        for name in get_args(ModelName):
            model_path(name)
    except ModelError as error:
        pytest.skip(f"needs the pose and hand models: {error}")


@pytest.fixture(scope="session")
def loaded_estimator(installed_models: None) -> Iterator[OnnxPoseEstimator]:
    """Return the one estimator of the session, for loading takes longer than most tests."""
    estimator = OnnxPoseEstimator(threads=1)
    yield estimator
    estimator.close()


@pytest.fixture
def estimator(loaded_estimator: OnnxPoseEstimator) -> OnnxPoseEstimator:
    """Return an estimator that has seen nothing yet."""
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
