"""Task bundles: two models in one file for MediaPipe's Tasks interface.

The wheel contains the bundles' parts. Only the pose landmark model lacks the description of its
input that the Tasks interface requires; it is added as MediaPipe's metadata writer does, by packing
the model again with one more buffer.
"""

from __future__ import annotations

import io
import struct
import zipfile
from collections.abc import Mapping
from typing import Any, Final

import flatbuffers  # type: ignore[import-untyped]

from release.models.schemas import Schemas
from release.models.tflite import FILE_IDENTIFIER

METADATA_BUFFER: Final = b"TFLITE_METADATA"
"""Buffer name of a model's description in TensorFlow Lite's tools."""

METADATA_IDENTIFIER: Final = b"M001"
"""``file_identifier`` of ``metadata_schema.fbs``."""

VECTOR_ALIGNMENT: Final = 16
"""``force_align`` of a buffer's data in ``schema.fbs``; Python's builder does not keep it."""

ENTRY_ALIGNMENT: Final = 64
"""Parts of a bundle start at multiples of this (a processor's cache line), since the library
maps the file into memory and uses them in place."""

EXTRA_FIELD: Final = 0xD935
"""Type of the zip extra field that Android's `zipalign` uses for such gaps."""

_LOCAL_HEADER: Final = 30
"""Bytes of a zip entry's local header before its name."""

_EXTRA_HEADER: Final = 4
"""Bytes of an extra field before its content: type and length."""

_UNIX: Final = 3
"""`ZipInfo.create_system`; set so that the bundle has the same bytes on every system."""


def task_bundle(parts: Mapping[str, bytes], schemas: Schemas) -> bytes:
    """Pack models into a bundle, uncompressed and aligned.

    Parameters
    ----------
    parts
        TensorFlow Lite models by their name in the bundle. A model without description gets one:
        an RGB image, scaled to [0, 1].
    schemas
        The generated modules of TensorFlow Lite's schemas.

    Returns
    -------
    The bytes of the ``.task`` file; always the same for the same input.

    """
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as bundle:
        for name, content in parts.items():
            entry = zipfile.ZipInfo(name)
            entry.create_system = _UNIX
            start = packed.tell() + _LOCAL_HEADER + len(name) + _EXTRA_HEADER
            gap = -start % ENTRY_ALIGNMENT
            entry.extra = struct.pack("<HH", EXTRA_FIELD, gap) + bytes(gap)
            bundle.writestr(entry, described(content, schemas))
    return packed.getvalue()


def described(content: bytes, schemas: Schemas) -> bytes:
    """Return the model with a description of its input; unchanged when it already has one."""
    schema = schemas.model
    model = schema.ModelT.InitFromPackedBuf(content, 0)
    model.metadata = model.metadata or []
    if any(entry.name == METADATA_BUFFER for entry in model.metadata):
        return content
    entry = schema.MetadataT()
    entry.name, entry.buffer = METADATA_BUFFER, len(model.buffers)
    model.metadata.append(entry)
    buffer = schema.BufferT()
    buffer.data = _description(len(model.subgraphs[0].outputs), schemas)
    model.buffers.append(buffer)
    builder = _DeterministicBuilder(len(content))
    builder.Finish(model.Pack(builder), FILE_IDENTIFIER)
    return bytes(builder.Output())


def _description(outputs: int, schemas: Schemas) -> bytes:
    """Describe a model that takes one RGB image scaled to [0, 1] and gives `outputs` tensors."""
    schema = schemas.metadata
    scaling = schema.NormalizationOptionsT()
    scaling.mean, scaling.std = [0.0], [255.0]
    step = schema.ProcessUnitT()
    step.optionsType, step.options = schema.ProcessUnitOptions.NormalizationOptions, scaling
    colours = schema.ImagePropertiesT()
    colours.colorSpace = schema.ColorSpaceType.RGB
    content = schema.ContentT()
    content.contentPropertiesType = schema.ContentProperties.ImageProperties
    content.contentProperties = colours
    limits = schema.StatsT()
    limits.min, limits.max = [0.0], [1.0]
    image = schema.TensorMetadataT()
    image.name, image.content, image.processUnits, image.stats = "image", content, [step], limits
    graph = schema.SubGraphMetadataT()
    graph.inputTensorMetadata = [image]
    graph.outputTensorMetadata = [schema.TensorMetadataT() for _ in range(outputs)]
    description = schema.ModelMetadataT()
    description.subgraphMetadata = [graph]
    builder = _DeterministicBuilder(0)
    builder.Finish(description.Pack(builder), METADATA_IDENTIFIER)
    return bytes(builder.Output())


class _DeterministicBuilder(flatbuffers.Builder):  # type: ignore[misc]
    """Aligns data as TensorFlow Lite requires, and writes the same bytes in every release.

    Releases of `flatbuffers` differ in which tables may share the description of their fields
    (25.12.19 changed it); here no two share one, which costs 20 kB of 6 MB.
    """

    def StartObject(self, numfields: int) -> None:  # noqa: N802
        self.vtables: dict[Any, int] = {}
        super().StartObject(numfields)

    def StartVector(self, elemSize: int, numElems: int, alignment: int) -> Any:  # noqa: N802, N803
        return super().StartVector(elemSize, numElems, max(alignment, VECTOR_ALIGNMENT))
