"""TensorFlow Lite models of a single operator, written for the tests."""

from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Final

import flatbuffers  # type: ignore[import-untyped]
import numpy as np
import numpy.typing as npt

ELEMENT_TYPES: Final = {"float32": 0, "float16": 1, "int32": 2}


@dataclass(frozen=True)
class OneOperator:
    """What the model is: one operator on one image and some constants.

    `sparsity` describes how the first constant is packed; its shape is then `packed_shape`.
    DENSIFY and DEQUANTIZE work on the constant, any other operator on image and constants.
    """

    kind: str
    options: Any
    image: tuple[int, ...]
    constants: Sequence[npt.NDArray[Any]]
    output: tuple[int, ...]
    sparsity: Any = None
    packed_shape: tuple[int, ...] = ()


def tflite_bytes(operator: OneOperator, schema: ModuleType) -> bytes:
    """Write the model as a TensorFlow Lite file with input ``image`` and output ``result``."""
    model = schema.ModelT()
    model.version = 3
    model.buffers = [schema.BufferT()]
    graph = schema.SubGraphT()
    graph.tensors = [_tensor(schema, "image", operator.image)]
    for number, values in enumerate(operator.constants):
        tensor = _tensor(schema, f"constant_{number}", values.shape, str(values.dtype))
        if number == 0 and operator.sparsity is not None:
            tensor.shape, tensor.sparsity = operator.packed_shape, operator.sparsity
        buffer = schema.BufferT()
        buffer.data = np.frombuffer(values.tobytes(), np.uint8)
        tensor.buffer = len(model.buffers)
        model.buffers.append(buffer)
        graph.tensors.append(tensor)
    graph.tensors.append(_tensor(schema, "result", operator.output))
    last = len(graph.tensors) - 1
    graph.inputs, graph.outputs = [0], [last]
    step = schema.OperatorT()
    first = 1 if operator.kind in ("DENSIFY", "DEQUANTIZE") else 0
    step.opcodeIndex, step.inputs, step.outputs = 0, list(range(first, last)), [last]
    if operator.options is not None:
        options = type(operator.options).__name__.removesuffix("T")
        step.builtinOptionsType = getattr(schema.BuiltinOptions, options)
        step.builtinOptions = operator.options
    graph.operators = [step]
    code = schema.OperatorCodeT()
    code.builtinCode = code.deprecatedBuiltinCode = getattr(schema.BuiltinOperator, operator.kind)
    code.version = 1
    model.operatorCodes, model.subgraphs = [code], [graph]
    builder = flatbuffers.Builder(0)
    builder.Finish(model.Pack(builder), b"TFL3")
    return bytes(builder.Output())


def _tensor(schema: ModuleType, name: str, shape: tuple[int, ...], element: str = "float32") -> Any:
    tensor = schema.TensorT()
    tensor.name, tensor.shape, tensor.type = name, list(shape), ELEMENT_TYPES[element]
    return tensor
