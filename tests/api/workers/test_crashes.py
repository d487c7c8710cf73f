"""Crashes and shutdowns of the server: acknowledged changes are there after its restart."""

from __future__ import annotations

import os
import signal
import sqlite3
import struct
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import httpx
import pytest

from tests.api.routes.clips.test_clips import CLIPS, upload
from tests.api.routes.clips.test_extraction_jobs import JOBS
from tests.api.routes.clips.test_resumable_uploads import begun, offset_of, sent
from tests.api.running import assert_problem, until
from tests.api.running_workers import alive, hold_worker, linux
from tests.api.serving import SERVE, served
from tests.recognition.damaged_clips import write_clip
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line, square, wedge

pytestmark = [pytest.mark.slow, linux]

STOP_SECONDS = 90
"""Seconds that systemd waits after SIGTERM; on an idle machine the server needs one or two."""


def working_on(clip: Path, process: subprocess.Popen[str], client: httpx.Client) -> tuple[str, int]:
    """Upload a clip and suspend its worker; return the job's id and the worker's."""
    job_id: str = upload(client, clip).json()["job_id"]
    worker = hold_worker(process.pid)
    until(lambda: client.get(f"{JOBS}/{job_id}").json()["status"] == "running")
    return job_id, worker


def finished(client: httpx.Client, job_id: str) -> Callable[[], bool]:
    return lambda: client.get(f"{JOBS}/{job_id}").json()["status"] in ("done", "failed")


@pytest.mark.withstands(row="H21")
def test_after_a_kill_the_job_is_taken_up_again(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4", frames=40)
    data = tmp_path / "data"
    with served(data) as (process, client):
        language = client.post("/api/v1/languages", json={"name": "kept"}).json()
        job_id, worker = working_on(clip, process, client)
        process.kill()
        process.wait()
    (data / "clips" / "half-an-upload.part").write_bytes(b"half")
    os.kill(worker, signal.SIGCONT)
    until(lambda: not alive(worker))
    with served(data) as (process, client):
        (listed,) = client.get("/api/v1/languages").json()
        assert listed == {key: language[key] for key in listed}
        until(finished(client, job_id))
        (kept,) = client.get(CLIPS).json()
        assert client.get(f"{CLIPS}/{kept['id']}/video").content == clip.read_bytes()
        # Done, or failed on a machine without models: in both cases the job ran again.
        assert kept["error_code"] in (None, "model_missing")
        assert [path.name for path in (data / "clips").iterdir()] == [kept["id"]]


@pytest.mark.withstands(row="H24")
def test_sigterm_ends_server_and_workers_soon_and_the_job_waits(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4", frames=40)
    data = tmp_path / "data"
    with served(data) as (process, client):
        job_id, worker = working_on(clip, process, client)
        with client.stream("GET", "/api/v1/events") as stream:
            next(stream.iter_lines())
            process.send_signal(signal.SIGTERM)
            process.wait(STOP_SECONDS)
        until(lambda: not alive(worker))
    with served(data) as (process, client):
        until(finished(client, job_id))


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM])
def test_a_stop_in_the_middle_of_work_is_told_and_leaves_no_traceback(
    tmp_path: Path, ending: signal.Signals
) -> None:
    clip = write_clip(tmp_path / "clip.mp4", frames=2)
    # More bytes than both sockets buffer, in a box that players skip: the client does not read to
    # the end, so the answer is still under way.
    free = 16_000_000
    clip.write_bytes(clip.read_bytes() + struct.pack(">I4s", free, b"free") + bytes(free - 8))
    with (tmp_path / "errors").open("w+") as errors, ThreadPoolExecutor(1) as other:
        with served(tmp_path / "data", errors) as (process, client):
            video = f"{CLIPS}/{upload(client, clip).json()['id']}/video"
            few = pool(circle=circle, line=line, wedge=wedge, square=square)
            # So many that the check is still at work when the server is stopped.
            many = [
                replace(gesture, label=f"{gesture.label} {number}")
                for number in range(60)
                for gesture in few.gestures
            ]
            document = replace(few, gestures=many).to_json()
            language = client.post("/api/v1/languages/import", content=document).json()["id"]
            with (
                client.stream("GET", video),
                client.stream("GET", "/api/v1/events") as events,
            ):
                checking = other.submit(client.get, f"/api/v1/languages/{language}/check")
                next(line for line in events.iter_lines() if line == "event: checks")
                process.send_signal(ending)
                process.wait(STOP_SECONDS)
            assert_problem(checking.result(), 503, "server_stopping")
        errors.seek(0)
        assert errors.read() == ""


@pytest.mark.withstands(row="H21")
def test_a_kill_right_after_the_answer_loses_nothing(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "clip.mp4")
    data = tmp_path / "data"
    acknowledged: list[str] = []
    with served(data) as (process, client):
        for count in range(3):
            answer = upload(client, clip, **{"Idempotency-Key": str(count)})
            acknowledged.append(answer.json()["id"])
            client.post("/api/v1/languages", json={"name": f"language {count}"})
        process.kill()
        process.wait()
    with served(data) as (process, client):
        assert {kept["id"] for kept in client.get(CLIPS).json()} == set(acknowledged)
        assert len(client.get("/api/v1/languages").json()) == len(acknowledged)
        for clip_id in acknowledged:
            assert client.get(f"{CLIPS}/{clip_id}/video").content == clip.read_bytes()


@pytest.mark.withstands(row="H31")
def test_a_kill_between_file_and_row_loses_no_acknowledged_part(tmp_path: Path) -> None:
    content = write_clip(tmp_path / "clip.mp4").read_bytes()
    data, last = tmp_path / "data", len(content) - 50
    with served(data) as (process, client), ThreadPoolExecutor(1) as other:
        place = begun(client, len(content))
        assert sent(client, place, 0, content[:last]).status_code == 204
        with closing(sqlite3.connect(data / "studio.db")) as database:
            database.execute("BEGIN IMMEDIATE")
            waiting = other.submit(sent, client, place, last, content[last:])
            until(lambda: list((data / "clips").glob("*/video")) != [])
            process.kill()
            process.wait()
        assert isinstance(waiting.exception(), httpx.HTTPError)
    with served(data) as (process, client):
        offset = offset_of(client, place)
        assert offset >= last
        clip = sent(client, place, offset, content[offset:]).headers["content-location"]
        assert client.get(f"{clip}/video").content == content
        assert list((data / "uploads").iterdir()) == []


@pytest.mark.withstands(row="H31")
def test_a_killed_probe_is_repeated_before_an_upload_is_refused(tmp_path: Path) -> None:
    content = write_clip(tmp_path / "clip.mp4").read_bytes()
    with served(tmp_path / "data") as (process, client), ThreadPoolExecutor(1) as other:
        place = begun(client, len(content))
        waiting = other.submit(sent, client, place, 0, content)
        os.kill(hold_worker(process.pid), signal.SIGKILL)
        clip = waiting.result().headers["content-location"]
        assert client.get(f"{clip}/video").content == content


def test_a_folder_in_use_or_damaged_ends_the_start_in_one_line(tmp_path: Path) -> None:
    data = tmp_path / "data"
    command = [sys.executable, "-c", SERVE, str(data)]
    with served(data):
        second = subprocess.run(command, capture_output=True, text=True, check=False)
    assert second.returncode == 2
    assert second.stderr.startswith("osg-studio: the data folder")
    assert second.stderr.count("\n") == 1
    (data / "studio.db").write_bytes(b"not a database, but long enough to be read as one" * 50)
    for leftover in data.glob("studio.db-*"):
        leftover.unlink()
    third = subprocess.run(command, capture_output=True, text=True, check=False)
    assert third.returncode == 2
    assert third.stderr.count("\n") == 1
    assert "restore a backup" in third.stderr
