"""A worker that reads a stranger's file has no secret, and opens nothing but that file."""

from __future__ import annotations

import asyncio
import importlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.api.workers import local_processes
from app.api.workers.executor import TaskFiles
from app.api.workers.local_processes import LocalProcesses
from app.api.workers.rights import environment_of_workers
from app.api.workers.tasks import Probe
from app.system.confinement import landlock_version
from tests.api.routes.clips.test_clips import CLIPS
from tests.api.running import assert_problem
from tests.api.running_workers import linux, workers_of
from tests.api.workers.test_local_processes import answers, order, record
from tests.keypoint_files.files import sleap_labels
from tests.recognition.damaged_clips import write_clip
from tests.recognition.strategies import BODY, circle, recording

pytestmark = pytest.mark.slow

SECRETS = {
    "OSG_TOKEN": "open-sesame",
    "OSG_DATABASE_URL": "postgresql+psycopg://osg:open-sesame@host/osg",
    "AWS_SECRET_ACCESS_KEY": "open-sesame",
    "SECRET_OF_ANOTHER_PROGRAM": "open-sesame",
}

landlock = pytest.mark.skipif(landlock_version() < 1, reason="this kernel has no Landlock")


@pytest.fixture
def secrets(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Put secrets into the environment of this process, before its fork server starts."""
    local_processes._fork_server.end()
    for name, value in SECRETS.items():
        monkeypatch.setenv(name, value)
    yield
    local_processes._fork_server.end()


@pytest.mark.withstands(row="H28")
@linux
@pytest.mark.usefixtures("secrets")
@pytest.mark.parametrize("way", ["forked", "started"])
def test_a_worker_has_no_secret_of_the_server(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, way: str
) -> None:
    monkeypatch.setattr(local_processes, "can_fork", lambda: way == "forked")
    clip = write_clip(tmp_path / "long.mp4", frames=500)

    async def look() -> bytes:
        async with LocalProcesses().start(order(record(clip))) as lines:
            await lines.readline()
            (worker,) = workers_of(os.getpid())
            return Path(f"/proc/{worker}/environ").read_bytes()

    environment = asyncio.run(look())
    assert b"PATH=" in environment
    assert b"open-sesame" not in environment


def test_the_environment_of_workers_names_models_and_threads_but_no_secret() -> None:
    needed = {"PATH": "/bin", "LC_ALL": "C", "OMP_NUM_THREADS": "1", "OSG_MODELS_DIR": "/models"}
    found = environment_of_workers({**needed, **SECRETS})
    assert found == {**needed, "ORT_DISABLE_TELEMETRY": "1"}


@landlock
@pytest.mark.parametrize("way", ["forked", "started"])
def test_a_worker_reads_no_file_but_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, way: str
) -> None:
    monkeypatch.setattr(local_processes, "can_fork", lambda: way == "forked")
    own, other = write_clip(tmp_path / "own.mp4"), write_clip(tmp_path / "other.mp4")
    # A process that a file has taken over would open another file than that of its task.
    task = Probe(source="video", file=other)
    (answer,) = asyncio.run(answers(task, TaskFiles((own,))))
    assert answer["kind"] == "failed"
    (answer,) = asyncio.run(answers(task))
    assert answer["kind"] == "probed"


@landlock
def test_a_worker_writes_nowhere_but_into_the_folders_of_its_results(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4", frames=2)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    denied = asyncio.run(answers(record(clip), record(clip, elsewhere).files))
    assert denied[-1]["code"] == "storage_unavailable"


@landlock
def test_a_worker_may_read_each_of_thousands_of_files(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4")
    others = [tmp_path / f"{number}.npz" for number in range(3000)]
    for other in others:
        other.touch()
    files = TaskFiles((*others, clip))
    (answer,) = asyncio.run(answers(Probe(source="video", file=clip), files))
    assert answer["kind"] == "probed"


def test_rights_are_taken_before_libraries_begin_threads() -> None:
    seen = "import sys, app.api.workers.__main__; print('numpy' in sys.modules)"
    ran = subprocess.run([sys.executable, "-c", seen], capture_output=True, text=True, check=True)
    assert ran.stdout == "False\n"


@pytest.mark.withstands(row="H28")
def test_a_keypoint_file_that_refers_to_another_file_is_refused_with_422(
    client: httpx.Client, tmp_path: Path
) -> None:
    library: Any = importlib.import_module("sleap_io")
    h5py: Any = importlib.import_module("h5py")
    secret, walk = tmp_path / "tokens.json", tmp_path / "walk.h5"
    secret.write_bytes(b"open-sesame" * 1000)
    poses = recording(circle, frames=8, landmarks=tuple(BODY))
    library.save_analysis_h5(sleap_labels(library, [poses], tracked=True), str(walk))

    def send() -> httpx.Response:
        data = {"frame_rate": "25", "frame_size": "640x480"}
        return client.post(CLIPS, files={"file": ("walk.h5", walk.read_bytes())}, data=data)

    assert send().status_code == 202
    with h5py.File(walk, "a") as file:
        shape = file["tracks"].shape
        del file["tracks"]
        file.create_dataset("tracks", shape, "u1", external=[(str(secret), 0, 10_000)])
    assert_problem(send(), 422, "keypoints_unreadable")
