"""Fixtures that several parts of the suite share."""

import os
from pathlib import Path

import pytest

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
