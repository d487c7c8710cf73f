"""Model sessions: refusals with the reason and what to do."""

from __future__ import annotations

import os
from pathlib import Path

import onnxruntime  # type: ignore[import-untyped]
import pytest

from app.recognition.errors import EstimatorError, ModelError
from app.recognition.estimation.landmark_models.body_model import POSE_SIGNATURE
from app.recognition.estimation.landmark_models.detector import PALM_LAYOUT, PERSON_LAYOUT
from app.recognition.estimation.landmark_models.hand_model import HAND_SIGNATURE
from app.recognition.estimation.landmark_models.onnx_session import (
    ModelSession,
    Provider,
    Signature,
    available_providers,
    check_provider,
)
from app.recognition.models.storage import ModelName, model_path

SIGNATURES: dict[ModelName, Signature] = {
    "pose_detection": PERSON_LAYOUT.signature,
    "palm_detection_full": PALM_LAYOUT.signature,
    "pose_landmark_full": POSE_SIGNATURE,
    "hand_landmark_full": HAND_SIGNATURE,
}


def load(path: Path, signature: Signature, provider: Provider = "cpu") -> ModelSession:
    return ModelSession(path, signature, threads=1, provider=provider)


@pytest.mark.usefixtures("installed_models")
@pytest.mark.parametrize("name", SIGNATURES)
def test_each_model_has_the_shapes_it_is_known_by(name: ModelName) -> None:
    session = load(model_path(name), SIGNATURES[name])
    session.pixels[:] = 127
    shapes = tuple(output.shape for output in session.run())
    assert shapes == SIGNATURES[name].outputs


@pytest.mark.usefixtures("installed_models")
def test_another_model_in_the_file_s_place_is_told_apart() -> None:
    with pytest.raises(ModelError, match=r"hand_landmark_full.*it is another model"):
        load(model_path("hand_landmark_full"), POSE_SIGNATURE)


@pytest.mark.usefixtures("installed_models")
def test_a_model_without_the_wanted_output_is_told_apart() -> None:
    with pytest.raises(ModelError, match=r"no output of shape \(1, 5\).*models install"):
        load(model_path("hand_landmark_full"), Signature(224, ((1, 63), (1, 5))))


def test_a_missing_file_is_named_with_the_command_that_mends_it(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"nowhere\.onnx.*osg-studio models install"):
        load(tmp_path / "nowhere.onnx", HAND_SIGNATURE)


@pytest.mark.usefixtures("installed_models")
@pytest.mark.parametrize("share", [0.0, 0.1, 0.99])
def test_a_truncated_file_is_named_in_one_line(tmp_path: Path, share: float) -> None:
    whole = model_path("hand_landmark_full").read_bytes()
    damaged = tmp_path / "damaged.onnx"
    damaged.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ModelError, match=r"damaged\.onnx.*models install") as caught:
        load(damaged, HAND_SIGNATURE)
    assert "\n" not in str(caught.value)


def test_the_runtime_reports_nothing_to_its_maker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ORT_DISABLE_TELEMETRY", raising=False)
    available_providers()
    assert os.environ["ORT_DISABLE_TELEMETRY"] == "1"


def test_the_processor_is_always_available() -> None:
    assert "cpu" in available_providers()
    check_provider("cpu")


def test_an_unknown_provider_is_refused_with_the_ones_there_are() -> None:
    with pytest.raises(EstimatorError, match=r"'npu'.*available here: .*cpu"):
        check_provider("npu")


@pytest.mark.skipif(
    "CoreMLExecutionProvider" in onnxruntime.get_available_providers(), reason="has CoreML"
)
def test_a_provider_this_machine_lacks_is_refused_with_the_ones_there_are() -> None:
    with pytest.raises(EstimatorError, match=r"'coreml'.*available here: .*cpu"):
        check_provider("coreml")
