"""Tasks in folders of their own: clips come from the object store, written files go back."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from app.api.services.running_studio import Studio
from app.api.workers.executor import TaskFiles
from app.api.workers.task_folders import OwnFolders, Written
from app.recognition import Recording
from app.settings import Settings
from app.store import StoreUnavailable
from app.store.objects import open_object_store
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.routes.clips.test_clips import upload
from tests.api.running import Running, until
from tests.api.running_workers import linux, workers_of
from tests.dask_cluster import Cluster, dask_cluster
from tests.recognition.damaged_clips import write_clip
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line
from tests.s3 import BUCKET, S3Server

STORAGE = f"s3://{BUCKET}/pool"
CLIP = "0123456789abcdef" * 2
FRAMES = 60


@pytest.fixture
def folders(tmp_path: Path) -> OwnFolders:
    root = tmp_path / "server"
    (root / "clips" / CLIP).mkdir(parents=True)
    return OwnFolders(root, root / "clips", STORAGE)


def test_a_task_works_in_its_own_folder_as_in_the_servers(
    folders: OwnFolders, s3: S3Server, tmp_path: Path
) -> None:
    root, there = tmp_path / "server", tmp_path / "task"
    received, scratch = root / "clips" / CLIP / "video", root / "clips" / ".unpacked-1"
    answers, request = scratch / "answers", scratch / "request.json"
    answers.mkdir(parents=True)
    request.write_text(json.dumps({"recording": str(received)}), encoding="utf-8")
    kept = tmp_path / "kept"
    kept.write_bytes(b"video")
    open_object_store(STORAGE).upload(kept, f"{CLIP}/video")
    found = root / "clips" / CLIP / "recording.npz"
    workspace = folders.describe(TaskFiles((received, request), (answers, found)))
    arguments = workspace.prepare(there, [f"--scratch={scratch / 'own'}", str(request)])
    assert arguments == [
        f"--scratch={there / 'clips' / '.unpacked-1' / 'own'}",
        str(there / "clips" / ".unpacked-1" / "request.json"),
    ]
    assert Path(arguments[0].partition("=")[2]).is_dir()
    wanted = Path(json.loads(Path(arguments[1]).read_text(encoding="utf-8"))["recording"])
    assert wanted.read_bytes() == b"video"
    written = Written(there, workspace)
    (there / "clips" / ".unpacked-1" / "answers" / "0.json").write_bytes(b"half")
    (there / "clips" / CLIP / "recording.npz").write_bytes(bytes(100))
    first = dict(written.take(50))
    (there / "clips" / ".unpacked-1" / "answers" / "0.json").write_bytes(b"whole")
    last = dict(written.take())
    for path, content in (first | last).items():
        folders.put(path, content)
    assert (len(last), (answers / "0.json").read_bytes()) == (2, b"whole")
    assert found.read_bytes() == bytes(100)
    assert dict(written.take()) == {}


def test_what_the_object_store_lacks_is_told(
    folders: OwnFolders, s3: S3Server, tmp_path: Path
) -> None:
    received = tmp_path / "server" / "clips" / CLIP / "video"
    workspace = folders.describe(TaskFiles((received,), ()))
    with pytest.raises(StoreUnavailable, match=f"holds no {CLIP}/video"):
        workspace.prepare(tmp_path / "task", [])


def test_what_is_written_for_a_clip_that_is_gone_is_left_out(
    folders: OwnFolders, tmp_path: Path
) -> None:
    folders.put("clips/elsewhere/poster.jpg", b"picture")
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
    command = Path(f"/proc/{worker}/cmdline").read_text()
    assert "/osg-task-" in command
    assert str(tmp_path) not in command
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
