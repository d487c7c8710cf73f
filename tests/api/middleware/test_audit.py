"""Audit: a change is acknowledged only when its entry is on the disk."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing

import httpx
import pytest

from app.api.middleware.audit import LONGEST_PATH
from app.settings import Settings
from app.store.audit import JOURNAL
from tests.api.running import Running, assert_problem, client_of, running

AUDIT, LANGUAGES = "/api/v1/audit", "/api/v1/languages"


@pytest.fixture
def refusing(server: Running, settings: Settings) -> Iterator[sqlite3.Connection]:
    """Return a connection to the database, which takes no entries until the trigger is dropped."""
    with closing(sqlite3.connect(settings.data_dir / "studio.db", timeout=60)) as database:
        database.execute(
            "CREATE TRIGGER refuse BEFORE INSERT ON audit_entry "
            "BEGIN SELECT RAISE(ABORT, 'full'); END"
        )
        yield database


@pytest.mark.withstands(row="H21")
def test_an_entry_that_was_kept_beside_the_database_is_there_after_the_next_start(
    settings: Settings,
) -> None:
    file = settings.data_dir / "studio.db"
    with running(settings) as server, client_of(server.address) as client:
        with closing(sqlite3.connect(file, timeout=60)) as database:
            database.execute(
                "CREATE TRIGGER refuse BEFORE INSERT ON audit_entry "
                "BEGIN SELECT RAISE(ABORT, 'full'); END"
            )
        assert client.post(LANGUAGES, json={"name": "pool"}).status_code == 201
    with closing(sqlite3.connect(file)) as database:
        database.execute("DROP TRIGGER refuse")
    with running(settings), closing(sqlite3.connect(file)) as database:
        assert database.execute("SELECT method FROM audit_entry").fetchall() == [("POST",)]


@pytest.mark.withstands(row="H22")
def test_a_change_whose_entry_can_be_kept_nowhere_is_not_acknowledged(
    client: httpx.Client, refusing: sqlite3.Connection, settings: Settings
) -> None:
    (settings.data_dir / JOURNAL).mkdir()
    refused = client.post(LANGUAGES, json={"name": "pool"})
    assert "audit log" in str(assert_problem(refused, 503, "store_unavailable")["detail"])
    assert "etag" not in refused.headers
    (settings.data_dir / JOURNAL).rmdir()
    refusing.execute("DROP TRIGGER refuse")
    assert client.post(LANGUAGES, json={"name": "sea"}).status_code == 201


def test_a_long_query_is_cut_visibly_and_the_path_is_whole(client: httpx.Client) -> None:
    language = client.post(LANGUAGES, json={"name": "pool"}).json()["id"]
    path = f"{LANGUAGES}/{language}"
    for query, shown in (("a=" + "b" * 1000, None), ("a=1", "?a=1")):
        assert client.patch(f"{path}?{query}", json={"name": query[:9]}).status_code == 200
        noted = client.get(AUDIT).json()[0]["path"]
        assert noted == (f"{path}{shown}" if shown else noted)
        assert noted.startswith(f"{path}?a=")
        if shown is None:
            assert len(noted) == LONGEST_PATH
            assert noted.endswith("b...")
