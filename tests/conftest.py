"""Fixtures that several parts of the suite share."""

import os
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import get_args

import pytest

from app.recognition import Recording, record
from app.recognition.errors import ModelError
from app.recognition.models import ModelName, model_path
from tests.command_line import OsgStudio

ROOT = Path(__file__).resolve().parents[1]
SHARED_DATA = Path(os.environ.get("OSG_SHARED_DATA", ROOT.parent / "shared" / "data"))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the files that take long, so that no worker is left alone with one in the end.

    Those with a limit of their own take minutes; after them come the folders with most slow tests.
    """
    slow = Counter(item.path.parent for item in items if item.get_closest_marker("slow"))
    items.sort(key=lambda item: (not item.get_closest_marker("timeout"), -slow[item.path.parent]))


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


@pytest.fixture(scope="session")
def sample_recording(
    tmp_path_factory: pytest.TempPathFactory, sample_clips: Path, installed_models: None
) -> Callable[[str], Recording]:
    """Return what finds the poses of a sample clip by its name, once in a run of the tests."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent  # which the workers have in common

    def recording_of(name: str) -> Recording:
        kept = folder / f"{name}.recording"
        if not kept.exists():
            own = tmp_path_factory.mktemp("recording") / name
            record(sample_clips / f"{name}.mp4").save(own)
            own.replace(kept)
        return Recording.load(kept)

    return recording_of


@pytest.fixture
def osg_studio(capsys: pytest.CaptureFixture[str]) -> OsgStudio:
    """Return what runs a command line and tells how it ended."""
    return OsgStudio(capsys)
