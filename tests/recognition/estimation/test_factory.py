"""Estimators by name."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, cast

import pytest

from app.recognition.errors import EstimatorError, ModelError
from app.recognition.estimation.factory import OnnxPoseEstimator, create_estimator


@pytest.mark.usefixtures("installed_models")
def test_onnx_runtime_is_the_default() -> None:
    estimator = create_estimator()
    assert isinstance(estimator, OnnxPoseEstimator)
    estimator.close()


def test_an_unknown_backend_is_refused_with_the_ones_there_are() -> None:
    with pytest.raises(EstimatorError, match=r"'openpose'; there are: onnx, mediapipe"):
        create_estimator(cast(Any, "openpose"))


def test_without_the_library_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mediapipe", None)
    with pytest.raises(EstimatorError, match=r"pip install 'osg-studio\[mediapipe\]'"):
        create_estimator("mediapipe")


@pytest.mark.parametrize("backend", ["onnx", "mediapipe"])
def test_missing_models_are_named_with_the_command_that_mends_it(
    backend: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if backend == "mediapipe":
        pytest.importorskip("mediapipe", reason="needs the extra `mediapipe`")
    monkeypatch.setenv("OSG_MODELS_DIR", str(tmp_path))
    with pytest.raises(ModelError, match=r"osg-studio models install"):
        create_estimator(backend)


def test_no_threads_are_too_few() -> None:
    with pytest.raises(EstimatorError, match="threads is 0"):
        create_estimator(threads=0)
