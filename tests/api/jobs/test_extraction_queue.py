"""The extraction queue: its jobs end even if the database cannot be written for a while."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import httpx
import pytest

from app.settings import Settings
from app.store import Clip
from tests.api.running import Running, client_of, running, until

pytestmark = pytest.mark.slow

JOBS = "/api/v1/jobs"


@contextmanager
def locked(settings: Settings) -> Iterator[None]:
    """Hold the write lock of the server's database."""
    with closing(sqlite3.connect(settings.data_dir / "studio.db", timeout=30)) as other:
        other.execute("BEGIN IMMEDIATE")
        yield
        other.rollback()


@pytest.fixture
def impatient(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> Iterator[Running]:
    """Serve with a database that gives up waiting for a lock at once."""
    monkeypatch.setattr("app.store.database.BUSY_TIMEOUT_SECONDS", 0.1)
    with running(settings) as server:
        yield server


def upload(client: httpx.Client, clip: Path) -> str:
    answer = client.post("/api/v1/clips", files={"file": ("dive.mp4", clip.read_bytes())})
    return str(answer.json()["job_id"])


def status(client: httpx.Client, job_id: str) -> str:
    return str(client.get(f"{JOBS}/{job_id}").json()["status"])


@pytest.mark.withstands(row="H22")
def test_a_job_whose_end_cannot_be_written_ends_once_it_can(
    impatient: Running,
    settings: Settings,
    small_clip: Path,
    caplog: pytest.LogCaptureFixture,
) -> None:
    with client_of(impatient.address) as client:
        job_id = upload(client, small_clip)
        until(lambda: status(client, job_id) == "running")
        with locked(settings):
            clip = client.get(f"{JOBS}/{job_id}").json()["clip_id"]
            folder = settings.data_dir / "clips" / clip
            # The worker removes its scratch folder when it ends.
            until(lambda: not list(folder.glob(".unpacked-*")))
            until(lambda: "cannot be stored yet" in caplog.text)
            assert status(client, job_id) == "running"
        until(lambda: status(client, job_id) in ("done", "failed"))
        job = client.get(f"{JOBS}/{job_id}").json()
        assert job["error_code"] != "internal"
        # The next job runs as well.
        other = upload(client, small_clip)
        until(lambda: status(client, other) in ("done", "failed"))


def test_a_job_that_cannot_be_started_starts_later(
    impatient: Running,
    settings: Settings,
    small_clip: Path,
    caplog: pytest.LogCaptureFixture,
) -> None:
    studio = impatient.studio
    with client_of(impatient.address) as client:
        partial = studio.clips.new_partial()
        partial.write_bytes(small_clip.read_bytes())
        clip = Clip(name="dive", media_type="video/x-matroska", size=5, width=64, height=48)
        job = studio.clips.add(clip, partial, "test").job
        with locked(settings):
            # On the server's event loop, as for a new clip.
            loop = studio.broadcast._loop
            loop.call_soon_threadsafe(loop.create_task, studio.extractions.submit(job))
            until(lambda: "cannot be stored yet" in caplog.text)
            assert status(client, job.id) == "queued"
        until(lambda: status(client, job.id) in ("done", "failed"))
