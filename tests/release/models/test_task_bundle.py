"""Task bundles: aligned, uncompressed, and every model described as the Tasks interface wants."""

import io
import struct
import zipfile
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.models.storage import TaskBundleName, task_bundle_path
from release.models.schemas import Schemas
from release.models.sources import BUNDLE_PARTS
from release.models.task_bundle import described, task_bundle

from .one_operator import OneOperator, tflite_bytes
from .runtimes import run_tflite


@pytest.fixture
def plain(schemas: Schemas) -> bytes:
    """Return a small model without description, with weights."""
    return small_model(7, schemas)


def small_model(channels: int, schemas: Schemas) -> bytes:
    slope = np.linspace(0, 1, channels, dtype=np.float32).reshape(1, 1, channels)
    shape = (1, 2, 2, channels)
    return tflite_bytes(OneOperator("PRELU", None, shape, [slope], shape), schemas.model)


@pytest.mark.parametrize("name", get_args(TaskBundleName))
def test_an_installed_bundle_holds_its_parts_where_they_can_be_mapped(name: TaskBundleName) -> None:
    content = task_bundle_path(name).read_bytes()
    with zipfile.ZipFile(io.BytesIO(content)) as bundle:
        assert bundle.namelist() == list(BUNDLE_PARTS[name])
        for entry in bundle.infolist():
            assert entry.compress_type == zipfile.ZIP_STORED
            assert data_offset(content, entry) % 64 == 0


@pytest.mark.parametrize("name", get_args(TaskBundleName))
def test_every_model_of_an_installed_bundle_is_described(
    schemas: Schemas, name: TaskBundleName
) -> None:
    with zipfile.ZipFile(task_bundle_path(name)) as bundle:
        for part in bundle.namelist():
            assert description(bundle.read(part), schemas).subgraphMetadata[0].inputTensorMetadata


@given(sizes=st.lists(st.integers(0, 200), min_size=1, max_size=4))
def test_parts_of_any_length_are_aligned(schemas: Schemas, sizes: list[int]) -> None:
    parts = {
        f"{number}{'x' * size}.tflite": small_model(size + 1, schemas)
        for number, size in enumerate(sizes)
    }
    content = task_bundle(parts, schemas)
    with zipfile.ZipFile(io.BytesIO(content)) as bundle:
        assert bundle.testzip() is None
        assert bundle.namelist() == list(parts)
        assert {data_offset(content, entry) % 64 for entry in bundle.infolist()} == {0}


def test_a_description_says_one_image_scaled_to_one(schemas: Schemas, plain: bytes) -> None:
    graph = description(described(plain, schemas), schemas).subgraphMetadata[0]
    (image,) = graph.inputTensorMetadata
    assert image.content.contentProperties.colorSpace == schemas.metadata.ColorSpaceType.RGB
    (scaling,) = (step.options for step in image.processUnits)
    assert (scaling.mean, scaling.std) == ([0.0], [255.0])
    assert len(graph.outputTensorMetadata) == 1


def test_a_described_model_still_computes_the_same(schemas: Schemas, plain: bytes) -> None:
    image = np.random.default_rng(0).normal(size=(1, 2, 2, 7)).astype(np.float32)
    expected = run_tflite(plain, image)["result"]
    np.testing.assert_array_equal(run_tflite(described(plain, schemas), image)["result"], expected)


def test_a_described_model_is_not_described_twice(schemas: Schemas, plain: bytes) -> None:
    once = described(plain, schemas)
    assert described(once, schemas) == once
    assert once != plain


def test_data_is_aligned_as_the_runtime_needs_it(schemas: Schemas, plain: bytes) -> None:
    content = described(plain, schemas)
    weights = np.linspace(0, 1, 7, dtype=np.float32).tobytes()
    assert content.count(weights) == 1
    assert content.index(weights) % 16 == 0


def description(content: bytes, schemas: Schemas) -> Any:
    """Return the description that a model carries."""
    model = schemas.model.ModelT.InitFromPackedBuf(content, 0)
    (buffer,) = (one.buffer for one in model.metadata if one.name == b"TFLITE_METADATA")
    packed = bytes(bytearray(model.buffers[buffer].data))
    assert packed[4:8] == b"M001"
    return schemas.metadata.ModelMetadataT.InitFromPackedBuf(packed, 0)


def data_offset(content: bytes, entry: zipfile.ZipInfo) -> int:
    """Return where an entry's data start, from its local header (APPNOTE 4.3.7)."""
    name, extra = struct.unpack_from("<HH", content, entry.header_offset + 26)
    return int(entry.header_offset + 30 + name + extra)
