"""One server for the tests of a file, which work on languages and clips of their own.

A folder's ``conftest.py`` imports these fixtures in place of those with a server for each test.
"""

from collections.abc import Iterator

import pytest

from app.settings import Settings
from tests.api.running import Running, running

__all__ = ["server", "settings"]


@pytest.fixture(scope="module")
def settings(tmp_path_factory: pytest.TempPathFactory) -> Settings:
    folder = tmp_path_factory.mktemp("studio")
    return Settings(data_dir=folder / "data", samples_dir=folder / "samples")


@pytest.fixture(scope="module")
def server(settings: Settings) -> Iterator[Running]:
    with running(settings) as server:
        yield server
