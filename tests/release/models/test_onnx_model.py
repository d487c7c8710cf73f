"""The converted models compute what TensorFlow Lite's own runtime computes."""

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import get_args

import numpy as np
import onnx
import pytest

from app.recognition.models.storage import ModelName, TaskBundleName, model_path, task_bundle_path
from app.recognition.recording.video import read_frames
from release.models.onnx_model import to_onnx
from release.models.schemas import Schemas
from release.models.sources import BUNDLE_PARTS, UNUSED_OUTPUTS

from .one_operator import OneOperator, tflite_bytes
from .runtimes import FloatTensor, run_onnx, run_tflite

RELATIVE = 1e-3
"""Allowed difference as a part of an output's largest value. Measured: landmarks and boxes 2e-5;
a wrong border or axis shows at 1e-1."""

ABSOLUTE = 1e-6
"""Allowed difference of a probability near zero, which the runtimes round differently."""


def tflite_of(name: ModelName) -> bytes:
    """Return the TensorFlow Lite model as it lies in an installed bundle."""
    bundles: tuple[TaskBundleName, ...] = get_args(TaskBundleName)
    bundle, part = next(
        (bundle, part)
        for bundle in bundles
        for part, model in BUNDLE_PARTS[bundle].items()
        if model == name
    )
    with zipfile.ZipFile(task_bundle_path(bundle)) as archive:
        return archive.read(part)


def side_of(name: ModelName) -> int:
    """Return the side in pixels of the image the model takes."""
    shape = onnx.load(model_path(name)).graph.input[0].type.tensor_type.shape
    return int(shape.dim[1].dim_value)


def original_results(name: ModelName, image: FloatTensor) -> dict[str, FloatTensor]:
    """Run the TensorFlow Lite model; leave out the outputs that the converted one lacks."""
    results = run_tflite(tflite_of(name), image)
    return {key: values for key, values in results.items() if key not in unused_by(name)}


def unused_by(name: ModelName) -> tuple[str, ...]:
    return UNUSED_OUTPUTS.get(name, ())


def assert_equal(converted: Mapping[str, FloatTensor], original: Mapping[str, FloatTensor]) -> None:
    assert converted.keys() == original.keys()
    for name, expected in original.items():
        assert converted[name].shape == expected.shape
        allowed = ABSOLUTE + RELATIVE * np.abs(expected).max()
        np.testing.assert_allclose(converted[name], expected, rtol=0, atol=allowed, err_msg=name)


@pytest.mark.parametrize("name", get_args(ModelName))
def test_noise_gives_the_same_numbers(name: ModelName) -> None:
    side = side_of(name)
    noise = np.random.default_rng(0).random((1, side, side, 3), np.float32)
    assert_equal(run_onnx(model_path(name).read_bytes(), noise), original_results(name, noise))


@pytest.mark.parametrize("name", get_args(ModelName))
def test_a_diver_gives_the_same_numbers(shared_data: Path, name: ModelName) -> None:
    side = side_of(name)
    frame = next(iter(read_frames(shared_data / "clips" / "diver_follow_me.webm"))).image
    rows, columns = (np.linspace(0, size - 1, side).astype(int) for size in frame.shape[:2])
    image = (frame[rows][:, columns] / 255).astype(np.float32)[np.newaxis]
    assert_equal(run_onnx(model_path(name).read_bytes(), image), original_results(name, image))


@pytest.mark.slow
def test_the_persons_mask_is_left_out_with_all_that_only_it_needs(schemas: Schemas) -> None:
    original = tflite_of("pose_landmark_full")
    whole = onnx.load_from_string(to_onnx(original, schemas.model, "credit"))
    reduced = onnx.load(model_path("pose_landmark_full"))
    assert unused_by("pose_landmark_full") == ("Identity_2",)
    left_out = {one.name for one in whole.graph.output} - {one.name for one in reduced.graph.output}
    assert left_out == {"Identity_2"}
    assert len(reduced.graph.node) < len(whole.graph.node)
    assert len(reduced.graph.initializer) < len(whole.graph.initializer)


@pytest.mark.parametrize("name", get_args(ModelName))
def test_a_converted_model_says_where_it_comes_from(name: ModelName) -> None:
    described = onnx.load(model_path(name)).doc_string
    for part in (f"{name}.tflite", "mediapipe==0.10.21", "Google LLC", "Apache-2.0", "converted"):
        assert part in described


def test_inputs_and_outputs_keep_name_and_order_of_axes(schemas: Schemas) -> None:
    operator = OneOperator("LOGISTIC", None, (1, 2, 3, 4), [], (1, 2, 3, 4))
    content = to_onnx(tflite_bytes(operator, schemas.model), schemas.model, "by whom")
    image = np.zeros((1, 2, 3, 4), np.float32)
    np.testing.assert_allclose(run_onnx(content, image)["result"], np.full((1, 2, 3, 4), 0.5))
    assert onnx.load_model_from_string(content).graph.input[0].name == "image"
