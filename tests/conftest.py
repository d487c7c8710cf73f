"""Fixtures that several parts of the suite share."""

import os
from pathlib import Path
from typing import get_args

import pytest

from app.recognition.errors import ModelError
from app.recognition.models import ModelName, model_path
from tests.command_line import OsgStudio

ROOT = Path(__file__).resolve().parents[1]
SHARED_DATA = Path(os.environ.get("OSG_SHARED_DATA", ROOT.parent / "shared" / "data"))


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Return the folder of real recordings by other people; skip where it does not lie at hand."""
    if not SHARED_DATA.is_dir():
        pytest.skip(f"needs the shared recordings, and there is no {SHARED_DATA}")
    return SHARED_DATA


@pytest.fixture(scope="session")
def sample_clips() -> Path:
    """Return the folder of our own rendered sample clips."""
    return ROOT / "languages" / "clips"


@pytest.fixture(scope="session")
def installed_models() -> None:
    """Skip where the models are not installed; `make test` installs them first."""
    try:
        for name in get_args(ModelName):
            model_path(name)
    except ModelError as error:
        pytest.skip(f"needs the pose and hand models: {error}")


@pytest.fixture
def osg_studio(capsys: pytest.CaptureFixture[str]) -> OsgStudio:
    """Return what runs a command line and tells how it ended."""
    return OsgStudio(capsys)
