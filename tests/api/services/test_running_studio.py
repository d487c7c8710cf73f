"""The store of a server: one server per data folder, and one per SQLite file."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.api.services.running_studio import check_store
from app.settings import Settings
from app.store import StoreUnavailable
from tests.api.running import running
from tests.postgres import Cluster


def test_a_second_server_on_one_sqlite_file_is_refused(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'shared' / 'studio.db'}"
    one, two = (
        Settings(data_dir=tmp_path / name, samples_dir=tmp_path / "none", database_url=url)
        for name in ("one", "two")
    )
    with (
        running(one),
        pytest.raises(StoreUnavailable, match=r"in use.*SQLite serves one server.*psycopg"),
    ):
        check_store(two)
    check_store(two)


@pytest.mark.slow
def test_several_servers_share_one_postgresql(tmp_path: Path, postgres: Cluster) -> None:
    url = postgres.new_database()
    one, two = (
        Settings(data_dir=tmp_path / name, samples_dir=tmp_path / "none", database_url=url)
        for name in ("one", "two")
    )
    with running(one):
        check_store(two)
        with pytest.raises(StoreUnavailable, match="one is in use"):
            check_store(one)
