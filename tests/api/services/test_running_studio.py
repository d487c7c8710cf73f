"""The store of a server: one server per data folder, and one per SQLite file."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.api.routes.languages import checks, language_files, languages
from app.api.services import language_responses, running_studio, stored_languages
from app.api.services.language_documents import draft_of
from app.api.services.limited_routes import MOST_COMPUTATIONS, MOST_EDITS
from app.api.services.running_studio import check_store, clean
from app.api.services.stored_languages import language_of
from app.recognition import Language
from app.settings import Settings
from app.store import NotFound, StoreUnavailable
from app.store.models import now
from app.ui.slate.layout import lay_out
from app.ui.slate.primitives import Page
from tests.api.running import PATIENCE_SECONDS, Running, client_of, running, until
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


def test_long_computations_of_many_clients_take_turns(
    server: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    at_work, most, free = 0, 0, threading.Event()

    def lay_out_slowly(language: Language) -> Page:
        nonlocal at_work, most
        at_work += 1
        most = max(most, at_work)
        free.wait(PATIENCE_SECONDS)
        at_work -= 1
        return lay_out(language)

    monkeypatch.setattr(language_files, "lay_out", lay_out_slowly)
    with client_of(server.address) as client, ThreadPoolExecutor(8) as others:
        language = client.post("/api/v1/languages", json={"name": "pool"}).json()["id"]
        place = f"/api/v1/languages/{language}/slate.svg"
        answers = [others.submit(client.get, place) for _ in range(8)]
        until(lambda: at_work == MOST_COMPUTATIONS)
        # Others are answered meanwhile.
        assert client.get(f"/api/v1/languages/{language}").status_code == 200
        free.set()
        assert {answer.result().status_code for answer in answers} == {200}
    assert most == MOST_COMPUTATIONS


def test_cached_languages_are_limited_by_their_documents(
    server: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    states = [
        server.studio.languages.create(draft_of(Language(name=name * 70), "made")) for name in "abc"
    ]
    size = len(states[0].revision.document)
    monkeypatch.setattr(stored_languages, "MOST_CACHED_CHARACTERS", 2 * size)
    first = language_of(states[0])
    assert language_of(states[0]) is first
    language_of(states[1])
    assert language_of(states[0]) is first
    for state in states[1:]:
        language_of(state)
    assert language_of(states[0]) is not first
    monkeypatch.setattr(stored_languages, "MOST_CACHED_CHARACTERS", 1)
    long = language_of(states[2])
    assert language_of(states[2]) is long


def test_what_is_told_of_languages_keeps_no_more_of_their_documents(
    client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stored_languages, "MOST_CACHED_CHARACTERS", 1)
    for name in ("pool", "sea", "lake"):
        made = client.post("/api/v1/languages", json={"name": name}).json()
        place = f"/api/v1/languages/{made['id']}"
        assert client.get(f"{place}/phrases").status_code == 200
        assert len(client.get(place).json()["sha256"]) == 64
    assert len(language_responses._checksums) == len(checks._ambiguities) == 1


def test_edits_of_languages_that_wait_take_no_thread(
    server: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    free, made = threading.Event(), list[str]()

    def describe_slowly(fields: Mapping[str, Any]) -> str:
        made.append(fields["author"])
        assert free.wait(PATIENCE_SECONDS)
        return "slow"

    monkeypatch.setattr(languages, "_describe", describe_slowly)
    with client_of(server.address) as client, ThreadPoolExecutor(50) as others:
        language = client.post("/api/v1/languages", json={"name": "pool"}).json()["id"]
        place = f"/api/v1/languages/{language}"
        answers = [
            others.submit(client.patch, place, json={"author": str(number)}) for number in range(50)
        ]
        until(lambda: len(made) == MOST_EDITS)
        # More wait than there are threads, and others are answered meanwhile.
        assert client.get(place).json()["revision"] == 1
        assert len(made) == MOST_EDITS
        free.set()
        assert {answer.result().status_code for answer in answers} == {200}
    assert sorted(made) == sorted(map(str, range(50)))
