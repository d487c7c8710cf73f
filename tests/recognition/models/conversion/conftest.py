"""The generated schemas of TensorFlow Lite, as the wheel carries them."""

import zipfile
from pathlib import Path

import pytest

from app.recognition.models.catalogue import METADATA_SCHEMA_SOURCE, MODEL_SCHEMA_SOURCE
from app.recognition.models.conversion import Schemas


@pytest.fixture(scope="session")
def schemas(wheel: Path) -> Schemas:
    with zipfile.ZipFile(wheel) as archive:
        return Schemas.from_source(
            model=archive.read(MODEL_SCHEMA_SOURCE), metadata=archive.read(METADATA_SCHEMA_SOURCE)
        )
