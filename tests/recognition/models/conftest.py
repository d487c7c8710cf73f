"""Fixtures for the models: a complete folder, and a copy of the test's own."""

import shutil
from pathlib import Path

import pytest

from app.recognition.models.storage import export_models


@pytest.fixture(scope="session")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder exported from the models in use; tests leave it as it is."""
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
