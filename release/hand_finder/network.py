"""Network: an ONNX graph of MediaPipe's hands as a PyTorch module that can be taught, and back.

The taught weights are written into the graph they came from, as half precision: the finder has the
shapes and the size of the detector and runs where it runs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import torch
import torch.nn.functional as functional
from onnx import numpy_helper

Values = dict[str, torch.Tensor]


class TaughtNetwork(torch.nn.Module):
    """A graph of convolutions whose weights of half precision are its parameters.

    Parameters
    ----------
    path
        The ONNX file.

    Raises
    ------
    KeyError
        At the first run, when the graph has an operator that is not known here.

    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._model = onnx.load(str(path))
        self._fixed = {
            tensor.name: numpy_helper.to_array(tensor) for tensor in self._model.graph.initializer
        }
        self.weights = torch.nn.ParameterDict(
            {
                name: torch.nn.Parameter(torch.tensor(values.astype(np.float32)))
                for name, values in self._fixed.items()
                if values.dtype == np.float16
            }
        )

    def forward(self, images: torch.Tensor) -> list[torch.Tensor]:
        """Return the outputs in the graph's order for images ``(N, side, side, 3)``, 0 to 1."""
        values: Values = dict(self.weights.items())
        values[self._model.graph.input[0].name] = images
        for node in self._model.graph.node:
            settings = {one.name: onnx.helper.get_attribute_value(one) for one in node.attribute}
            given = [values.get(name) for name in node.input]
            constants = [self._fixed.get(name) for name in node.input]
            values[node.output[0]] = OPERATORS[node.op_type](given, constants, settings)
        return [values[output.name] for output in self._model.graph.output]

    def write(self, path: Path) -> None:
        """Write the graph with the weights as they are now."""
        for tensor in self._model.graph.initializer:
            if tensor.name in self.weights:
                taught = self.weights[tensor.name].detach().numpy().astype(np.float16)
                tensor.CopyFrom(numpy_helper.from_array(taught, tensor.name))
        path.write_bytes(self._model.SerializeToString(deterministic=True))


Operator = Callable[[Sequence[Any], Sequence[Any], Mapping[str, Any]], torch.Tensor]


def _convolve(given: Sequence[Any], _: Sequence[Any], settings: Mapping[str, Any]) -> torch.Tensor:
    top, left, bottom, right = settings["pads"]
    image = given[0]
    if (top, left) != (bottom, right):
        image, (top, left) = functional.pad(image, (left, right, top, bottom)), (0, 0)
    return functional.conv2d(
        image, given[1], given[2], settings["strides"], (top, left), groups=settings["group"]
    )


def _pad(given: Sequence[Any], constants: Sequence[Any], _: Mapping[str, Any]) -> torch.Tensor:
    axes = len(constants[1]) // 2
    pairs = [(constants[1][axis], constants[1][axis + axes]) for axis in reversed(range(axes))]
    return functional.pad(given[0], [int(side) for pair in pairs for side in pair])


def _resize(given: Sequence[Any], constants: Sequence[Any], _: Mapping[str, Any]) -> torch.Tensor:
    scale = [float(factor) for factor in constants[2][2:]]
    return functional.interpolate(given[0], scale_factor=scale, mode="bilinear")


OPERATORS: dict[str, Operator] = {
    "Add": lambda given, _, __: given[0] + given[1],
    "Clip": lambda given, bounds, _: given[0].clamp(bounds[1].item(), bounds[2].item()),
    "Cast": lambda given, _, __: given[0],
    "Concat": lambda given, _, settings: torch.cat(list(given), settings["axis"]),
    "Conv": _convolve,
    "Gemm": lambda given, _, __: given[0] @ given[1].T + given[2],
    "Identity": lambda given, _, __: given[0],
    "MaxPool": lambda given, _, settings: functional.max_pool2d(
        given[0], settings["kernel_shape"], settings["strides"]
    ),
    "PRelu": lambda given, _, __: functional.prelu(given[0], given[1].reshape(-1)),
    "Pad": _pad,
    "ReduceMean": lambda given, _, settings: given[0].mean(dim=list(settings["axes"])),
    "Reshape": lambda given, constants, _: given[0].reshape(
        -1, *(int(size) for size in constants[1][1:])
    ),
    "Resize": _resize,
    "Sigmoid": lambda given, _, __: torch.sigmoid(given[0].clamp(-15, 15)),
    "Transpose": lambda given, _, settings: given[0].permute(*settings["perm"]),
}
"""The operators of MediaPipe's palm detector and hand landmark model."""
