"""What a server does with its store: brings it in order at the start, waits while it is locked."""

import sqlite3
from contextlib import closing

import httpx
import pytest

from app.api.services.studio import check_store
from app.settings import Settings
from app.store import StoreUnavailable
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import Running, assert_problem, running

LANGUAGES = "/api/v1/languages"


def test_what_was_deleted_long_ago_is_removed_at_the_start(settings: Settings) -> None:
    hasty = settings.model_copy(update={"undo_hours": 0.0})
    with running(hasty) as server, httpx.Client(base_url=server.address, timeout=60) as client:
        kept, gone = (add_recorded_clip(server.studio, recording_of("line")) for _ in range(2))
        client.delete(f"/api/v1/clips/{gone}")
        language = client.post(LANGUAGES, json={"name": "gone"}).json()["id"]
        client.delete(f"{LANGUAGES}/{language}")
    with running(hasty) as server, httpx.Client(base_url=server.address, timeout=60) as client:
        assert [path.name for path in server.studio.clips.folder.iterdir()] == [kept]
        assert_problem(client.post(f"/api/v1/clips/{gone}/restore"), 404, "not_found")
        assert_problem(client.post(f"{LANGUAGES}/{language}/restore"), 404, "not_found")


def test_what_was_deleted_just_now_can_be_restored_after_a_restart(settings: Settings) -> None:
    with running(settings) as server, httpx.Client(base_url=server.address, timeout=60) as client:
        clip_id = add_recorded_clip(server.studio, recording_of("line"))
        client.delete(f"/api/v1/clips/{clip_id}")
    with running(settings) as server, httpx.Client(base_url=server.address, timeout=60) as client:
        assert client.post(f"/api/v1/clips/{clip_id}/restore").json()["status"] == "done"
        assert len(client.get(f"/api/v1/clips/{clip_id}/takes").json()) == 1


@pytest.mark.slow
@pytest.mark.withstands(row="H22")
def test_while_the_database_is_locked_changes_are_503_and_reading_goes_on(
    settings: Settings, client: httpx.Client
) -> None:
    with closing(sqlite3.connect(settings.data_dir / "studio.db")) as other:
        other.execute("BEGIN IMMEDIATE")
        answer = client.post(LANGUAGES, json={"name": "pool"})
        assert_problem(answer, 503, "store_unavailable")
        assert answer.headers["retry-after"]
        assert client.get(LANGUAGES).json() == []
        other.rollback()
    assert client.post(LANGUAGES, json={"name": "pool"}).status_code == 201


def test_a_store_in_use_is_told_before_the_server_starts(
    settings: Settings, server: Running
) -> None:
    assert server.studio.settings.data_dir == settings.data_dir
    with pytest.raises(StoreUnavailable, match="in use by another OSG Studio"):
        check_store(settings)
