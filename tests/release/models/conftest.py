"""Fixtures: MediaPipe's wheel, its schemas of TensorFlow Lite, and a pip that is cut off."""

import zipfile
from pathlib import Path

import pytest

from app.recognition.errors import ModelError
from release.models.schemas import Schemas
from release.models.sources import METADATA_SCHEMA_SOURCE, MODEL_SCHEMA_SOURCE
from release.models.wheel import download_wheel


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return MediaPipe's wheel; skip where pip cannot obtain it."""
    try:
        return download_wheel(tmp_path_factory.mktemp("wheel"))
    except ModelError as error:
        pytest.skip(f"needs MediaPipe's wheel: {error}")


@pytest.fixture
def pip_offline(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Cut pip off from its index; return the empty folder that it searches instead."""
    links = tmp_path / "links"
    links.mkdir()
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(links))
    return links


@pytest.fixture(scope="session")
def schemas(wheel: Path) -> Schemas:
    with zipfile.ZipFile(wheel) as archive:
        return Schemas.from_source(
            model=archive.read(MODEL_SCHEMA_SOURCE), metadata=archive.read(METADATA_SCHEMA_SOURCE)
        )
