"""ONNX graph builder: nodes and weights from TensorFlow Lite tensors, in the right axis order."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final, Literal

import numpy as np
import numpy.typing as npt
from onnx import NodeProto, TensorProto, helper, numpy_helper

from app.recognition.errors import ModelError
from release.models.tflite import TfliteModel

Layout = Literal["stored", "channels_first"]
"""Order of a value's axes: as in the TensorFlow Lite file, or batch, channels, height, width."""

_TRANSPOSITIONS: Final[dict[Layout, list[int]]] = {
    "channels_first": [0, 3, 1, 2],
    "stored": [0, 2, 3, 1],
}
"""Axes of the other layout in the order that gives this one."""


@dataclass
class GraphBuilder:
    """Collects the nodes and weights of the ONNX graph of one model.

    TensorFlow Lite orders an image's axes batch, height, width, channels; ONNX convolves batch,
    channels, height, width. Each value is kept in the layout in which it was computed and
    transposed, once, when a step needs the other.

    Attributes
    ----------
    model
        The model being converted.
    nodes, weights
        The ONNX graph so far.

    """

    model: TfliteModel
    nodes: list[NodeProto] = field(default_factory=list)
    weights: list[TensorProto] = field(default_factory=list)
    _values: dict[tuple[int, Layout], str] = field(default_factory=dict)

    def shape(self, index: int) -> tuple[int, ...]:
        """Return a tensor's shape in the order of axes of the TensorFlow Lite file."""
        return self.model.tensors[index].shape

    def set_value(self, index: int, name: str, layout: Layout) -> None:
        """Record that the ONNX value `name` is the tensor `index`, in the given layout."""
        self._values[index, layout] = name

    def layout(self, index: int) -> Layout:
        """Return the layout in which a tensor was computed."""
        return "stored" if (index, "stored") in self._values else "channels_first"

    def value(self, index: int, layout: Layout) -> str:
        """Return the ONNX value of a computed tensor, transposed if necessary."""
        if (index, layout) not in self._values:
            other = self._values[index, self.layout(index)]
            self._values[index, layout] = self.add(
                "Transpose", [other], perm=_TRANSPOSITIONS[layout]
            )
        return self._values[index, layout]

    def add(self, kind: str, inputs: list[str], **attributes: Any) -> str:
        """Add a node with one output; return the name of its value."""
        name = f"{kind.lower()}_{len(self.nodes)}"
        self.nodes.append(helper.make_node(kind, inputs, [name], name=name, **attributes))
        return name

    def weight(self, values: npt.NDArray[Any]) -> str:
        """Add a constant; return the name of its value.

        Half precision stays so in the file, which halves it; ONNX Runtime widens it at loading.
        """
        name = f"weight_{len(self.weights)}"
        self.weights.append(numpy_helper.from_array(np.ascontiguousarray(values), name))
        if values.dtype == np.float16:
            return self.add("Cast", [name], to=TensorProto.FLOAT)
        return name

    def constant(self, index: int) -> npt.NDArray[Any]:
        """Return the value of a tensor that the file must hold.

        Raises
        ------
        ModelError
            When the tensor is computed instead.

        """
        constant = self.model.tensors[index].constant
        if constant is None:
            raise ModelError(
                f"tensor {self.model.tensors[index].name!r} is computed, and only a constant is "
                f"known there"
            )
        return constant
