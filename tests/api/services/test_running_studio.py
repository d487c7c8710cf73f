"""The store of a server: one server per data folder, and one per SQLite file."""

from __future__ import annotations

from datetime import timedelta
from pathlib import Path

import pytest

from app.api.services import running_studio
from app.api.services.running_studio import check_store, clean
from app.settings import Settings
from app.store import NotFound, StoreUnavailable
from app.store.models import now
from tests.api.running import running, until
from tests.postgres import Cluster
from tests.store.conftest import add_clip


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


@pytest.mark.withstands(row="H33")
def test_deleted_clips_leave_the_disk_while_the_server_runs(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(running_studio, "CLEANING_SECONDS", 0.05)
    eager = settings.model_copy(update={"undo_hours": 0})
    with running(eager) as server:
        clips = server.studio.clips
        clip_id = add_clip(clips).clip.id
        clips.delete(clip_id)
        until(lambda: not (clips.folder / clip_id).exists())
        with pytest.raises(NotFound):
            clips.restore(clip_id)


def test_a_start_with_the_clock_set_forward_ends_no_undo(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    with running(settings) as server:
        clip_id = add_clip(server.studio.clips).clip.id
        server.studio.clips.delete(clip_id)
    later = now() + timedelta(days=6)
    monkeypatch.setattr(running_studio, "now", lambda: later)
    with running(settings) as server:
        server.studio.clips.restore(clip_id)
        server.studio.clips.delete(clip_id)
        clean(server.studio, later)
        with pytest.raises(NotFound):
            server.studio.clips.restore(clip_id)
