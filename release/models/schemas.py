"""TensorFlow Lite schemas: the generated readers of its file format, from MediaPipe's wheel."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType


@dataclass(frozen=True)
class Schemas:
    """Python modules that `flatc` generated from TensorFlow's schemas.

    Attributes
    ----------
    model
        Reads and writes the models (``schema.fbs``).
    metadata
        Writes the description of a model's inputs and outputs (``metadata_schema.fbs``).

    """

    model: ModuleType
    metadata: ModuleType

    @classmethod
    def from_source(cls, model: bytes, metadata: bytes) -> Schemas:
        """Create the modules from their Python source.

        The source is executed: pass only source that was checked against its pinned SHA-256.
        """
        return cls(
            model=_module("tflite_schema", model), metadata=_module("tflite_metadata", metadata)
        )


def _module(name: str, source: bytes) -> ModuleType:
    module = ModuleType(name)
    exec(compile(source, f"<{name}>", "exec"), module.__dict__)
    return module
