"""TensorFlow Lite reader: the tensors, constants and operators of a model in execution order."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from app.recognition.errors import ModelError

FILE_IDENTIFIER: Final = b"TFL3"
"""Bytes 4 to 8 of every TensorFlow Lite file (``file_identifier`` in ``schema.fbs``)."""

_ELEMENT_TYPES: Final[dict[int, npt.DTypeLike]] = {
    0: np.float32,
    1: np.float16,
    2: np.int32,
    4: np.int64,
}
"""NumPy's types by TensorFlow Lite's ``TensorType``, as far as the models use them."""

_FOLDED: Final = frozenset({"DEQUANTIZE", "DENSIFY"})
"""Operators that only unpack a stored constant; they are evaluated while reading."""

_DENSE: Final = 0
"""``DimensionType.DENSE``: every index of the dimension is stored."""


@dataclass(frozen=True, eq=False)
class Tensor:
    """One tensor of a model.

    Attributes
    ----------
    name
        Its name in the file.
    shape
        Its extent per axis; images are batch, height, width, channels.
    constant
        Its value where the file holds one (weights; half precision stays half precision),
        None where it is computed.

    """

    name: str
    shape: tuple[int, ...]
    constant: npt.NDArray[Any] | None


@dataclass(frozen=True, eq=False)
class Operator:
    """One step of the computation; `inputs` and `output` index the model's tensors.

    Attributes
    ----------
    kind
        TensorFlow Lite's name of the operator, for instance ``"CONV_2D"``.
    options
        Its generated options object, None where the operator has none.
    inputs, output
        Tensors it reads and the one it computes.

    """

    kind: str
    options: Any
    inputs: tuple[int, ...]
    output: int


@dataclass(frozen=True, eq=False)
class TfliteModel:
    """A model as a list of operators over numbered tensors."""

    tensors: tuple[Tensor, ...]
    operators: tuple[Operator, ...]
    inputs: tuple[int, ...]
    outputs: tuple[int, ...]


def read_tflite(content: bytes, schema: ModuleType) -> TfliteModel:
    """Read a model of one subgraph; packed constants come out dense.

    Parameters
    ----------
    content
        The bytes of the ``.tflite`` file.
    schema
        The generated module of TensorFlow Lite's model schema.

    Raises
    ------
    ModelError
        When it is no TensorFlow Lite file, or stores a constant in a way not known here.

    """
    if content[4:8] != FILE_IDENTIFIER:
        raise ModelError(
            f"not a TensorFlow Lite model: it is marked {content[4:8]!r}, not {FILE_IDENTIFIER!r}"
        )
    model = schema.ModelT.InitFromPackedBuf(content, 0)
    graph = model.subgraphs[0]
    kinds = {code: name for name, code in vars(schema.BuiltinOperator).items()}
    constants = {
        index: _constant(stored, model.buffers[stored.buffer].data)
        for index, stored in enumerate(graph.tensors)
    }
    operators = []
    for stored in graph.operators:
        operator = _operator(stored, model.operatorCodes, kinds)
        if operator.kind in _FOLDED:
            constants[operator.output] = constants[operator.inputs[0]]
        else:
            operators.append(operator)
    return TfliteModel(
        tensors=tuple(
            Tensor(stored.name.decode(), _shape(stored), constants[index])
            for index, stored in enumerate(graph.tensors)
        ),
        operators=tuple(operators),
        inputs=tuple(int(index) for index in graph.inputs),
        outputs=tuple(int(index) for index in graph.outputs),
    )


def _operator(stored: Any, codes: Any, kinds: dict[int, str]) -> Operator:
    code = codes[stored.opcodeIndex]
    return Operator(
        # Operator numbers beyond one byte are in a second field; writers fill the one that fits.
        kind=kinds[max(code.builtinCode, code.deprecatedBuiltinCode)],
        options=stored.builtinOptions,
        inputs=tuple(int(index) for index in stored.inputs),
        output=int(stored.outputs[0]),
    )


def _shape(stored: Any) -> tuple[int, ...]:
    return () if stored.shape is None else tuple(int(extent) for extent in stored.shape)


def _constant(stored: Any, content: Any) -> npt.NDArray[Any] | None:
    """Return the dense value of a stored tensor, or None when nothing is stored for it."""
    if content is None or len(content) == 0:
        return None
    if stored.type not in _ELEMENT_TYPES:
        raise ModelError(f"tensor {stored.name!r} has element type {stored.type}, not known here")
    values = np.asarray(content, np.uint8).view(_ELEMENT_TYPES[stored.type])
    shape = _shape(stored)
    if stored.sparsity is None:
        return values.reshape(shape)
    return _dense(values, shape, stored.sparsity)


def _dense(values: npt.NDArray[Any], shape: tuple[int, ...], sparsity: Any) -> npt.NDArray[Any]:
    """Spread the stored values of a tensor whose last dimension is compressed (CSR).

    TensorFlow Lite can compress any dimensions, in any order and in blocks; the pose detector
    uses only this one form.
    """
    dimensions = sparsity.dimMetadata
    plain_order = [int(axis) for axis in sparsity.traversalOrder] == list(range(len(shape)))
    only_last = [dimension.format != _DENSE for dimension in dimensions] == (
        [False] * (len(shape) - 1) + [True]
    )
    if not (plain_order and only_last):
        raise ModelError("a sparse tensor is packed in blocks or another order, not known here")
    starts = np.asarray(dimensions[-1].arraySegments.values, np.intp)
    columns = np.asarray(dimensions[-1].arrayIndices.values, np.intp)
    rows = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    dense = np.zeros((len(starts) - 1, shape[-1]), values.dtype)
    dense[rows, columns] = values
    return dense.reshape(shape)
