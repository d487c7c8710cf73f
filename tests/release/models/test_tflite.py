"""Reading TensorFlow Lite files: packed constants come out as they were before packing."""

from types import ModuleType
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from app.recognition.errors import ModelError
from release.models.schemas import Schemas
from release.models.tflite import read_tflite

from .one_operator import OneOperator, tflite_bytes

halves = st.floats(-4, 4, width=16)
weights = arrays.arrays(
    np.float16,
    st.tuples(st.integers(1, 5), st.integers(1, 3), st.integers(1, 3), st.integers(1, 300)),
    elements=st.one_of(st.just(0.0), halves),
)


def compressed(dense: npt.NDArray[Any], schema: ModuleType) -> Any:
    """Describe `dense` with its last dimension compressed, as TensorFlow's own tools do it."""
    rows = dense.reshape(-1, dense.shape[-1])
    starts = np.r_[0, np.cumsum(np.count_nonzero(rows, axis=1))]
    columns = np.nonzero(rows)[1]
    sparsity = schema.SparsityParametersT()
    sparsity.traversalOrder = list(range(dense.ndim))
    sparsity.dimMetadata = []
    for extent in dense.shape[:-1]:
        dimension = schema.DimensionMetadataT()
        dimension.format, dimension.denseSize = 0, extent
        sparsity.dimMetadata.append(dimension)
    last = schema.DimensionMetadataT()
    last.format = 1
    last.arraySegmentsType = last.arrayIndicesType = schema.SparseIndexVector.Int32Vector
    last.arraySegments, last.arrayIndices = schema.Int32VectorT(), schema.Int32VectorT()
    last.arraySegments.values, last.arrayIndices.values = starts.tolist(), columns.tolist()
    sparsity.dimMetadata.append(last)
    return sparsity


def unpacking(dense: npt.NDArray[Any], sparsity: Any) -> OneOperator:
    return OneOperator(
        "DENSIFY",
        None,
        image=(1, 1, 1, 1),
        constants=[dense[dense != 0]],
        output=dense.shape,
        sparsity=sparsity,
        packed_shape=dense.shape,
    )


@given(dense=weights)
def test_a_compressed_constant_is_read_as_it_was(schemas: Schemas, dense: npt.NDArray[Any]) -> None:
    dense = dense.copy()
    dense.flat[0] = 1  # a buffer without a single value means "computed", not "all zero"
    operator = unpacking(dense, compressed(dense, schemas.model))
    content = tflite_bytes(operator, schemas.model)
    read = read_tflite(content, schemas.model)
    constant = read.tensors[1].constant
    assert constant is not None
    np.testing.assert_array_equal(constant, dense)
    assert constant.dtype == np.float16


def test_a_constant_compressed_another_way_is_refused(schemas: Schemas) -> None:
    dense = np.ones((2, 1, 1, 3), np.float16)
    sparsity = compressed(dense, schemas.model)
    sparsity.traversalOrder = [3, 1, 2, 0]
    content = tflite_bytes(unpacking(dense, sparsity), schemas.model)
    with pytest.raises(ModelError, match="sparse tensor is packed in blocks or another order"):
        read_tflite(content, schemas.model)


def test_half_precision_stays_half_precision(schemas: Schemas) -> None:
    values = np.arange(6, dtype=np.float16).reshape(1, 1, 2, 3)
    operator = OneOperator("DEQUANTIZE", None, (1, 1, 1, 1), [values], values.shape)
    read = read_tflite(tflite_bytes(operator, schemas.model), schemas.model)
    assert read.operators == ()
    widened = read.tensors[read.outputs[0]].constant
    assert widened is not None
    assert widened.dtype == np.float16
    np.testing.assert_array_equal(widened, values)


@pytest.mark.parametrize("content", [b"", b"\x89PNG\r\n\x1a\n and more", b"\x1c\0\0\0TFL2"])
def test_another_file_is_refused(schemas: Schemas, content: bytes) -> None:
    with pytest.raises(ModelError, match="not a TensorFlow Lite model"):
        read_tflite(content, schemas.model)
