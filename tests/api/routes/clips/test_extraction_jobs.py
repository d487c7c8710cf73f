"""Jobs over HTTP: progress as it happens, cancelling, and workers that break or hang."""

import json
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from app.settings import Limits, Settings
from tests.api.routes.clips.test_clips import CLIPS, upload
from tests.api.running import assert_problem, client_of, running, until
from tests.api.running_workers import alive, hold_worker, linux, workers_of
from tests.recognition.damaged_clips import write_clip

pytestmark = pytest.mark.slow

JOBS = "/api/v1/jobs"


@pytest.fixture(scope="module")
def long_clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a clip that takes longer than a test needs to disturb its job."""
    return write_clip(tmp_path_factory.mktemp("clips") / "long.mp4", frames=2000)


def events_of(client: httpx.Client, job_id: str) -> Iterator[dict[str, Any]]:
    """Yield the events of a job's stream, to its end."""
    with client.stream("GET", f"{JOBS}/{job_id}/events") as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        for line in stream.iter_lines():
            if line.startswith("data:"):
                yield json.loads(line.removeprefix("data:"))


def frozen_worker(client: httpx.Client, clip: Path) -> tuple[str, int]:
    """Upload a clip, suspend its worker, and return the job's id and the worker's."""
    job_id: str = upload(client, clip).json()["job_id"]
    return job_id, hold_worker(os.getpid())


def test_progress_and_poses_are_told_until_the_end(
    client: httpx.Client, thin_clip: Callable[[str], Path]
) -> None:
    accepted = upload(client, thin_clip("circle-demonstration")).json()
    clip_id, job_id = accepted["id"], accepted["job_id"]
    events = list(events_of(client, job_id))
    assert events[-1]["status"] == "done"
    poses = client.get(f"{CLIPS}/{clip_id}/poses").json()
    frames = len(poses["time"])
    assert (events[-1]["done"], events[-1]["total"]) == (frames, frames)
    arriving = [event for event in events if event["stage"] == "poses"]
    counted = [event["done"] for event in arriving]
    assert counted == sorted(counted)
    assert 0 < counted[-1] <= frames  # a slow listener gets only the newest
    for event in arriving:
        frame = event["done"] - 1
        assert event["time"] == pytest.approx(poses["time"][frame], abs=0.001)
        assert np.multiply(event["pose"], poses["frame_size"]) == pytest.approx(
            np.array(poses["xy"][frame]), abs=0.1
        )
    assert events[-1]["time"] is events[-1]["pose"] is None
    for event in events:
        assert {"stage", "done", "total", "eta_s"} <= set(event)
        assert 0 <= event["done"] <= event["total"]
    job = client.get(f"{JOBS}/{job_id}").json()
    assert job["status"] == "done"
    assert job["started"] <= job["finished"]


def test_a_job_that_is_over_tells_so_once(client: httpx.Client, circle_clip: str) -> None:
    job_id = client.get(f"{CLIPS}/{circle_clip}").json()["job_id"]
    (event,) = events_of(client, job_id)
    assert event["status"] == "done"
    again = client.get(f"{JOBS}/{job_id}/events", headers={"Last-Event-ID": "final"})
    assert again.status_code == 204


@linux
@pytest.mark.withstands(row="H23")
def test_a_running_job_can_be_cancelled_and_tried_again(
    client: httpx.Client, long_clip: Path
) -> None:
    job_id, worker = frozen_worker(client, long_clip)
    assert client.get(f"{JOBS}/{job_id}").json()["status"] == "running"
    assert client.delete(f"{JOBS}/{job_id}").json()["status"] == "cancelled"
    until(lambda: not alive(worker))
    (clip,) = client.get(CLIPS).json()
    assert clip["status"] == "cancelled"
    assert client.delete(f"{JOBS}/{job_id}").json()["status"] == "cancelled"
    retried = client.post(f"{CLIPS}/{clip['id']}/jobs").json()
    until(lambda: workers_of(os.getpid()))
    assert_problem(client.post(f"{CLIPS}/{clip['id']}/jobs"), 409, "job_not_needed")
    client.delete(f"{JOBS}/{retried['job_id']}")


@linux
def test_deleting_a_clip_ends_its_job_and_its_streams(
    client: httpx.Client, long_clip: Path
) -> None:
    job_id, worker = frozen_worker(client, long_clip)
    events = events_of(client, job_id)
    assert next(events)["status"] == "running"
    (clip,) = client.get(CLIPS).json()
    assert client.delete(f"{CLIPS}/{clip['id']}").status_code == 204
    until(lambda: not alive(worker))
    assert list(events)[-1]["status"] == "cancelled"
    assert_problem(client.get(f"{JOBS}/{job_id}"), 404, "not_found")


@linux
@pytest.mark.withstands(row="H10")
def test_a_worker_that_crashes_fails_its_job_and_nothing_else(
    client: httpx.Client, long_clip: Path
) -> None:
    job_id, worker = frozen_worker(client, long_clip)
    waiting = upload(client, long_clip).json()["job_id"]
    os.kill(worker, signal.SIGKILL)
    until(lambda: client.get(f"{JOBS}/{job_id}").json()["status"] == "failed")
    job = client.get(f"{JOBS}/{job_id}").json()
    assert job["error_code"] == "decoder"
    assert "convert it" in job["error"]
    until(lambda: client.get(f"{JOBS}/{waiting}").json()["status"] != "queued")


@linux
def test_a_worker_that_hangs_is_ended(settings: Settings, long_clip: Path) -> None:
    # Long enough for the worker to begin; else it has ended before it is suspended.
    impatient = settings.model_copy(update={"limits": Limits(worker_silence_seconds=5.0)})
    with running(impatient) as server, client_of(server.address) as client:
        job_id, worker = frozen_worker(client, long_clip)
        until(lambda: client.get(f"{JOBS}/{job_id}").json()["status"] == "failed")
        job = client.get(f"{JOBS}/{job_id}").json()
        assert job["error_code"] == "decoder"
        assert "no progress" in job["error"]
        until(lambda: not alive(worker))


@pytest.mark.skipif(os.name != "posix", reason="POSIX resource limits")
def test_a_clip_is_not_called_damaged_where_memory_ends_within_its_decoder(
    settings: Settings, tmp_path: Path
) -> None:
    clip = write_clip(tmp_path / "large.mp4", frames=2, size=(3840, 2160))
    for megabytes in range(560, 2000, 20):
        limits = Limits(worker_memory_bytes=megabytes * 1024 * 1024)
        narrow = settings.model_copy(update={"limits": limits})
        with running(narrow) as server, client_of(server.address) as client:
            answer = upload(client, clip)
        if answer.status_code == 202:
            break
        assert "memory" in answer.json()["detail"], megabytes
    else:
        pytest.fail("the clip is never accepted")


@pytest.mark.skipif(os.name != "posix", reason="POSIX resource limits")
@pytest.mark.withstands(row="H10")
def test_a_clip_that_needs_too_much_memory_is_refused(settings: Settings, tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "large.mp4", frames=2, size=(3840, 2160))
    narrow = settings.model_copy(update={"limits": Limits(worker_memory_bytes=100 * 1024 * 1024)})
    with running(narrow) as server, client_of(server.address) as client:
        refused = upload(client, clip)
        assert refused.status_code == 422
        assert "memory" in refused.json()["detail"]
        assert client.get("/healthz").status_code == 200
