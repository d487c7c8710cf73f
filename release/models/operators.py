"""Operator conversion: the ONNX nodes of each TensorFlow Lite operator of MediaPipe's models.

Sources: TensorFlow Lite's ``schema.fbs`` and reference kernels; ONNX operators, opset 13.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from app.recognition.errors import ModelError
from release.models.graph import GraphBuilder
from release.models.tflite import Operator

_VALID_PADDING: Final = 1
"""``Padding.VALID``: no border. The other value, SAME, adds one so that stride alone shrinks."""

_NO_ACTIVATION, _RELU, _RELU6 = 0, 1, 3
"""``ActivationFunctionType``: the activation fused into an operator."""

Converter = Callable[[GraphBuilder, Operator], None]


def convert_operator(graph: GraphBuilder, operator: Operator) -> None:
    """Add the ONNX nodes of one operator to the graph.

    Raises
    ------
    ModelError
        When the operator, or its fused activation, is none that MediaPipe's models use.

    """
    if operator.kind not in _CONVERTERS:
        raise ModelError(f"operator {operator.kind} has no conversion to ONNX here")
    _CONVERTERS[operator.kind](graph, operator)


def _convolution(graph: GraphBuilder, operator: Operator) -> None:
    # Stored: output channels, height, width, input channels.
    kernel = graph.constant(operator.inputs[1]).transpose(0, 3, 1, 2)
    _add_convolution(graph, operator, kernel, groups=1)


def _depthwise_convolution(graph: GraphBuilder, operator: Operator) -> None:
    # Stored: 1, height, width, channels; in ONNX each channel is a group of its own.
    kernel = graph.constant(operator.inputs[1]).transpose(3, 0, 1, 2)
    _add_convolution(graph, operator, kernel, groups=graph.shape(operator.inputs[0])[3])


def _add_convolution(
    graph: GraphBuilder, operator: Operator, kernel: npt.NDArray[Any], groups: int
) -> None:
    options = operator.options
    strides = [options.strideH, options.strideW]
    dilations = [options.dilationHFactor, options.dilationWFactor]
    extent = [
        (size - 1) * dilation + 1
        for size, dilation in zip(kernel.shape[2:], dilations, strict=True)
    ]
    name = graph.add(
        "Conv",
        [
            graph.value(operator.inputs[0], "channels_first"),
            graph.weight(kernel),
            graph.weight(graph.constant(operator.inputs[2])),
        ],
        kernel_shape=list(kernel.shape[2:]),
        strides=strides,
        dilations=dilations,
        group=groups,
        pads=_border(graph, operator, extent, strides),
    )
    graph.set_value(operator.output, _add_activation(graph, operator, name), "channels_first")


def _max_pooling(graph: GraphBuilder, operator: Operator) -> None:
    options = operator.options
    window = [options.filterHeight, options.filterWidth]
    strides = [options.strideH, options.strideW]
    name = graph.add(
        "MaxPool",
        [graph.value(operator.inputs[0], "channels_first")],
        kernel_shape=window,
        strides=strides,
        pads=_border(graph, operator, window, strides),
    )
    graph.set_value(operator.output, _add_activation(graph, operator, name), "channels_first")


def _addition(graph: GraphBuilder, operator: Operator) -> None:
    layout = graph.layout(operator.inputs[0])
    name = graph.add("Add", [graph.value(index, layout) for index in operator.inputs])
    graph.set_value(operator.output, _add_activation(graph, operator, name), layout)


def _parametric_relu(graph: GraphBuilder, operator: Operator) -> None:
    # Stored: height, width, channels, of which height and width are 1.
    slope = graph.constant(operator.inputs[1]).transpose(2, 0, 1)
    image = graph.value(operator.inputs[0], "channels_first")
    name = graph.add("PRelu", [image, graph.weight(slope)])
    graph.set_value(operator.output, name, "channels_first")


def _padding(graph: GraphBuilder, operator: Operator) -> None:
    # Stored: a row per axis with the border before and after; ONNX wants all before, all after.
    border = graph.constant(operator.inputs[1])[[0, 3, 1, 2]]
    image = graph.value(operator.inputs[0], "channels_first")
    name = graph.add("Pad", [image, graph.weight(border.T.ravel().astype(np.int64))])
    graph.set_value(operator.output, name, "channels_first")


def _bilinear_resizing(graph: GraphBuilder, operator: Operator) -> None:
    if operator.options.alignCorners or not operator.options.halfPixelCenters:
        raise ModelError("a resize does not align pixel centres, which is not known here")
    before, after = graph.shape(operator.inputs[0]), graph.shape(operator.output)
    scales = np.array([1, 1, after[1] / before[1], after[2] / before[2]], np.float32)
    name = graph.add(
        "Resize",
        [graph.value(operator.inputs[0], "channels_first"), "", graph.weight(scales)],
        mode="linear",
        coordinate_transformation_mode="half_pixel",
    )
    graph.set_value(operator.output, name, "channels_first")


def _depth_to_space(graph: GraphBuilder, operator: Operator) -> None:
    image = graph.value(operator.inputs[0], "channels_first")
    # TensorFlow takes the block's row and column from the front of the channel number: "DCR".
    name = graph.add("DepthToSpace", [image], blocksize=operator.options.blockSize, mode="DCR")
    graph.set_value(operator.output, name, "channels_first")


def _reshaping(graph: GraphBuilder, operator: Operator) -> None:
    value = graph.value(operator.inputs[0], "stored")
    shape = np.array(graph.shape(operator.output), np.int64)
    name = graph.add("Reshape", [value, graph.weight(shape)])
    graph.set_value(operator.output, name, "stored")


def _concatenation(graph: GraphBuilder, operator: Operator) -> None:
    parts = [graph.value(index, "stored") for index in operator.inputs]
    name = graph.add("Concat", parts, axis=operator.options.axis)
    graph.set_value(operator.output, _add_activation(graph, operator, name), "stored")


def _logistic(graph: GraphBuilder, operator: Operator) -> None:
    layout = graph.layout(operator.inputs[0])
    name = graph.add("Sigmoid", [graph.value(operator.inputs[0], layout)])
    graph.set_value(operator.output, name, layout)


def _mean(graph: GraphBuilder, operator: Operator) -> None:
    axes = sorted(int(axis) for axis in graph.constant(operator.inputs[1]).ravel())
    if axes != [1, 2] or operator.options.keepDims:
        raise ModelError(f"a mean over axes {axes} is none over an image, which is not known here")
    image = graph.value(operator.inputs[0], "channels_first")
    name = graph.add("ReduceMean", [image], axes=[2, 3], keepdims=0)
    graph.set_value(operator.output, name, "stored")


def _fully_connected(graph: GraphBuilder, operator: Operator) -> None:
    value, weights, bias = operator.inputs
    name = graph.add(
        "Gemm",
        [
            graph.value(value, "stored"),
            graph.weight(graph.constant(weights)),
            graph.weight(graph.constant(bias)),
        ],
        transB=1,
    )
    graph.set_value(operator.output, _add_activation(graph, operator, name), "stored")


def _add_activation(graph: GraphBuilder, operator: Operator, name: str) -> str:
    """Apply the operator's fused activation to the value `name`."""
    activation = operator.options.fusedActivationFunction
    if activation == _NO_ACTIVATION:
        return name
    if activation == _RELU:
        return graph.add("Relu", [name])
    if activation == _RELU6:
        lowest, highest = (graph.weight(np.array(bound, np.float32)) for bound in (0, 6))
        return graph.add("Clip", [name, lowest, highest])
    raise ModelError(f"{operator.kind} ends in activation {activation}, not known here")


def _border(
    graph: GraphBuilder, operator: Operator, extent: Sequence[int], strides: Sequence[int]
) -> list[int]:
    """Return the rows above, columns left, rows below and columns right to add.

    With SAME padding the output has ``ceil(size / stride)`` rows; of an odd border the larger
    half goes below and to the right (TensorFlow's rule).
    """
    if operator.options.padding == _VALID_PADDING:
        return [0, 0, 0, 0]
    before, after = [], []
    sizes = graph.shape(operator.inputs[0])[1:3]
    for size, window, stride in zip(sizes, extent, strides, strict=True):
        steps = -(-size // stride)
        total = max((steps - 1) * stride + window - size, 0)
        before.append(total // 2)
        after.append(total - total // 2)
    return before + after


_CONVERTERS: Final[dict[str, Converter]] = {
    "ADD": _addition,
    "CONCATENATION": _concatenation,
    "CONV_2D": _convolution,
    "DEPTH_TO_SPACE": _depth_to_space,
    "DEPTHWISE_CONV_2D": _depthwise_convolution,
    "FULLY_CONNECTED": _fully_connected,
    "LOGISTIC": _logistic,
    "MAX_POOL_2D": _max_pooling,
    "MEAN": _mean,
    "PAD": _padding,
    "PRELU": _parametric_relu,
    "RESHAPE": _reshaping,
    "RESIZE_BILINEAR": _bilinear_resizing,
}
