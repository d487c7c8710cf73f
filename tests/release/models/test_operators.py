"""Single operators give in ONNX Runtime what they give in TensorFlow Lite's own runtime."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.errors import ModelError
from release.models.onnx_model import to_onnx
from release.models.schemas import Schemas

from .one_operator import OneOperator, tflite_bytes
from .runtimes import run_onnx, run_tflite

SAME, VALID = 0, 1
NO_ACTIVATION, RELU, RELU6, TANH = 0, 1, 3, 4


def steps(size: int, window: int, stride: int, padding: int) -> int:
    """Return the number of window positions along an axis."""
    return -(-(size if padding == SAME else size - window + 1) // stride)


def assert_equal_on_both(operator: OneOperator, schemas: Schemas, seed: int) -> None:
    content = tflite_bytes(operator, schemas.model)
    image = np.random.default_rng(seed).normal(size=operator.image).astype(np.float32)
    expected = run_tflite(content, image)["result"]
    converted = run_onnx(to_onnx(content, schemas.model, "test"), image)["result"]
    np.testing.assert_allclose(converted, expected, rtol=1e-5, atol=1e-5)


def set_window(options: Any, stride: tuple[int, int], padding: int, activation: int) -> Any:
    options.strideH, options.strideW = stride
    options.padding = padding
    options.fusedActivationFunction = activation
    return options


windows = st.fixed_dictionaries(
    {
        "size": st.tuples(st.integers(6, 11), st.integers(6, 11)),
        "window": st.tuples(st.integers(1, 3), st.integers(1, 3)),
        "stride": st.tuples(st.integers(1, 3), st.integers(1, 3)),
        "dilation": st.integers(1, 2),
        "padding": st.sampled_from([SAME, VALID]),
        "activation": st.sampled_from([NO_ACTIVATION, RELU, RELU6]),
        "seed": st.integers(0, 9),
    }
)


@pytest.mark.slow
@given(case=windows, channels=st.tuples(st.integers(1, 4), st.integers(1, 4)))
def test_convolution(schemas: Schemas, case: dict[str, Any], channels: tuple[int, int]) -> None:
    generator = np.random.default_rng(case["seed"])
    # TensorFlow Lite dilates or strides, and not both; the models do neither at once.
    dilation = case["dilation"] if case["stride"] == (1, 1) else 1
    options = schemas.model.Conv2DOptionsT()
    set_window(options, case["stride"], case["padding"], case["activation"])
    options.dilationHFactor = options.dilationWFactor = dilation
    shape = output_shape(case, dilation, channels[1])
    kernel = generator.normal(size=(channels[1], *case["window"], channels[0]))
    bias = generator.normal(size=channels[1])
    operator = OneOperator(
        "CONV_2D",
        options,
        (1, *case["size"], channels[0]),
        [kernel.astype(np.float32), bias.astype(np.float32)],
        shape,
    )
    assert_equal_on_both(operator, schemas, case["seed"])


@given(case=windows, channels=st.integers(1, 4))
def test_depthwise_convolution(schemas: Schemas, case: dict[str, Any], channels: int) -> None:
    generator = np.random.default_rng(case["seed"])
    # TensorFlow Lite's depthwise kernels take one stride for both axes.
    case = case | {"stride": (case["stride"][0],) * 2}
    dilation = case["dilation"] if case["stride"] == (1, 1) else 1
    options = schemas.model.DepthwiseConv2DOptionsT()
    set_window(options, case["stride"], case["padding"], case["activation"])
    options.dilationHFactor = options.dilationWFactor = dilation
    options.depthMultiplier = 1
    kernel = generator.normal(size=(1, *case["window"], channels)).astype(np.float32)
    bias = generator.normal(size=channels).astype(np.float32)
    shape = output_shape(case, dilation, channels)
    operator = OneOperator(
        "DEPTHWISE_CONV_2D", options, (1, *case["size"], channels), [kernel, bias], shape
    )
    assert_equal_on_both(operator, schemas, case["seed"])


@given(case=windows)
def test_max_pooling(schemas: Schemas, case: dict[str, Any]) -> None:
    options = schemas.model.Pool2DOptionsT()
    set_window(options, case["stride"], case["padding"], case["activation"])
    options.filterHeight, options.filterWidth = case["window"]
    operator = OneOperator(
        "MAX_POOL_2D", options, (1, *case["size"], 2), [], output_shape(case, 1, 2)
    )
    assert_equal_on_both(operator, schemas, case["seed"])


def output_shape(case: dict[str, Any], dilation: int, channels: int) -> tuple[int, ...]:
    height, width = (
        steps(size, (window - 1) * dilation + 1, stride, case["padding"])
        for size, window, stride in zip(case["size"], case["window"], case["stride"], strict=True)
    )
    return (1, height, width, channels)


@given(
    border=st.tuples(*[st.tuples(st.integers(0, 2), st.integers(0, 3))] * 3),
    seed=st.integers(0, 9),
)
def test_padding(schemas: Schemas, border: tuple[tuple[int, int], ...], seed: int) -> None:
    rows = np.array([(0, 0), *border], np.int32)
    shape = tuple(int(size) for size in np.array([1, 4, 5, 3]) + rows.sum(axis=1))
    operator = OneOperator("PAD", schemas.model.PadOptionsT(), (1, 4, 5, 3), [rows], shape)
    assert_equal_on_both(operator, schemas, seed)


def test_depth_to_space_keeps_the_order_of_the_block(schemas: Schemas) -> None:
    options = schemas.model.DepthToSpaceOptionsT()
    options.blockSize = 2
    operator = OneOperator("DEPTH_TO_SPACE", options, (1, 3, 4, 12), [], (1, 6, 8, 3))
    assert_equal_on_both(operator, schemas, 0)


def test_an_operator_without_conversion_is_named(schemas: Schemas) -> None:
    operator = OneOperator("TANH", None, (1, 2, 2, 1), [], (1, 2, 2, 1))
    with pytest.raises(ModelError, match="operator TANH has no conversion"):
        to_onnx(tflite_bytes(operator, schemas.model), schemas.model, "test")


def test_an_unknown_activation_is_named(schemas: Schemas) -> None:
    options = set_window(schemas.model.Pool2DOptionsT(), (1, 1), VALID, TANH)
    options.filterHeight = options.filterWidth = 1
    operator = OneOperator("MAX_POOL_2D", options, (1, 2, 2, 1), [], (1, 2, 2, 1))
    with pytest.raises(ModelError, match="MAX_POOL_2D ends in activation 4"):
        to_onnx(tflite_bytes(operator, schemas.model), schemas.model, "test")


def test_a_resize_by_corners_is_refused(schemas: Schemas) -> None:
    options = schemas.model.ResizeBilinearOptionsT()
    options.alignCorners = True
    size = np.array([4, 4], np.int32)
    operator = OneOperator("RESIZE_BILINEAR", options, (1, 2, 2, 1), [size], (1, 4, 4, 1))
    with pytest.raises(ModelError, match="does not align pixel centres"):
        to_onnx(tflite_bytes(operator, schemas.model), schemas.model, "test")


def test_a_mean_over_channels_is_refused(schemas: Schemas) -> None:
    axes = np.array([3], np.int32)
    options = schemas.model.ReducerOptionsT()
    operator = OneOperator("MEAN", options, (1, 2, 2, 3), [axes], (1, 2, 2))
    with pytest.raises(ModelError, match=r"mean over axes \[3\]"):
        to_onnx(tflite_bytes(operator, schemas.model), schemas.model, "test")
