"""Tasks in folders of their own: clips come from the object store, written files go back."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.api.workers.dask_cluster import OwnFolder, _contents
from app.api.workers.executor import Order
from app.api.workers.tasks import Record
from app.recognition import Recording
from app.settings import Settings
from app.store import StoreUnavailable
from app.store.objects import open_object_store
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.routes.clips.test_clips import upload
from tests.api.running import Running, until
from tests.api.running_workers import linux, workers_of
from tests.api.workers.test_local_processes import order, record
from tests.dask_cluster import Cluster, dask_cluster
from tests.recognition.damaged_clips import write_clip
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line
from tests.s3 import BUCKET, S3Server

STORAGE = f"s3://{BUCKET}/pool"
CLIP = "0123456789abcdef" * 2
FRAMES = 60


@pytest.fixture
def folder(tmp_path: Path) -> OwnFolder:
    root = tmp_path / "server"
    (root / "clips" / CLIP).mkdir(parents=True)
    return OwnFolder(root, root / "clips", STORAGE)


def test_a_task_works_in_its_own_folder_as_in_the_servers(
    folder: OwnFolder, s3: S3Server, tmp_path: Path
) -> None:
    root, there = tmp_path / "server", tmp_path / "task"
    clip = root / "clips" / CLIP
    sent = tmp_path / "sent"
    sent.write_bytes(b"video")
    open_object_store(STORAGE).upload(sent, f"{CLIP}/video")
    task = record(clip / "video", clip / "found")
    (clip / "found").mkdir()
    given = Order(task.model_dump_json(), task.files, root / "clips" / ".unpacked-1")
    prepared = folder.prepare(given, there)
    assert prepared.scratch == there / "clips" / ".unpacked-1"
    assert prepared.scratch.is_dir()
    moved = Record.model_validate_json(prepared.task)
    assert moved.files == prepared.files
    assert moved.file.read_bytes() == b"video"
    moved.recording.write_bytes(bytes(100))
    moved.poster.write_bytes(b"picture")
    task.poster.write_bytes(b"earlier")
    folder.put(_contents(prepared.files.outputs, str(there)))
    assert task.recording.read_bytes() == bytes(100)
    assert task.poster.read_bytes() == b"picture"
    assert not task.filmstrip.exists()


def test_what_the_object_store_lacks_is_told(
    folder: OwnFolder, s3: S3Server, tmp_path: Path
) -> None:
    received = tmp_path / "server" / "clips" / CLIP / "video"
    with pytest.raises(StoreUnavailable, match=f"holds no {CLIP}/video"):
        folder.prepare(order(record(received)), tmp_path / "task")


def test_what_is_written_for_a_clip_that_is_gone_is_left_out(
    folder: OwnFolder, tmp_path: Path
) -> None:
    folder.put({"clips/elsewhere/poster.jpg": b"picture"})
    assert not (tmp_path / "server" / "clips" / "elsewhere").exists()


@pytest.fixture
def cluster(s3: S3Server, tmp_path: Path) -> Iterator[Cluster]:
    """Return a cluster of one machine, which finds the bucket by its environment."""
    with dask_cluster(tmp_path, workers=1) as cluster:
        yield cluster


@pytest.fixture
def settings(tmp_path: Path, cluster: Cluster) -> Settings:
    return Settings(
        data_dir=tmp_path / "data",
        samples_dir=tmp_path / "none",
        executor=f"dask://{cluster.address}",
        storage=STORAGE,
    )


def open_files(process: int) -> list[str]:
    """Return what a process has open."""
    places = list(Path(f"/proc/{process}/fd").iterdir())
    with suppress(FileNotFoundError):
        return [str(place.readlink()) for place in places]
    return []


@linux
@pytest.mark.slow
@pytest.mark.usefixtures("installed_models")
def test_every_kind_of_job_runs_without_a_folder_in_common(
    client: httpx.Client,
    server: Running,
    studio: Studio,
    s3: S3Server,
    cluster: Cluster,
    tmp_path: Path,
    caplog: pytest.LogCaptureFixture,
) -> None:
    machine = cluster.workers[0].pid
    os.kill(machine, signal.SIGSTOP)
    ids = upload(client, write_clip(tmp_path / "clip.mp4", frames=FRAMES)).json()
    # A failed download is tried again.
    kept = (studio.clips.place(ids["id"], "video"), f"{ids['id']}/video")
    s3.client().delete_object(Bucket=BUCKET, Key=f"pool/{kept[1]}")
    os.kill(machine, signal.SIGCONT)
    until(lambda: f"holds no {kept[1]}" in caplog.text)
    open_object_store(STORAGE).upload(*kept)
    until(lambda: workers_of(machine, "record"))
    (worker,) = workers_of(machine, "record")
    until(lambda: any("/osg-task-" in each for each in open_files(worker)))
    assert not any(str(studio.settings.data_dir) in each for each in open_files(worker))
    until(lambda: client.get(f"/api/v1/jobs/{ids['job_id']}").json()["status"] == "done")
    found = Recording.load(studio.clips.recording(ids["id"]))
    assert len(found.poses) == FRAMES
    names = {name.removeprefix(f"pool/{ids['id']}/") for name in s3.names()}
    assert names == {"video", "recording.npz", "poster.jpg", "filmstrip.jpg"}
    assert not list(studio.clips.folder.glob("*/.*"))
    content = pool(circle=circle, line=line).to_json()
    language = client.post("/api/v1/languages/import", content=content).json()["id"]
    assert client.get(f"/api/v1/languages/{language}/check").status_code == 200
    shown = add_recorded_clip(studio, recording_of("circle", "line"))
    takes = f"/api/v1/languages/{language}/test-set"
    client.post(takes, json={"takes": [{"clip_id": shown, "expected": "circle"}]})
    assert client.post(f"{takes}/run").json()["overall"]["asked"] == 2
    exported = client.get(f"/api/v1/clips/{shown}/session.mcap")
    assert exported.content.startswith(b"\x89MCAP")
