"""Two servers on one PostgreSQL and one bucket, each with a folder that starts empty."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from app.store.clips import RECORDING
from tests.api.languages import LANGUAGES, add_gesture
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.routes.clips.test_clips import CLIPS, upload
from tests.api.running import Running, assert_problem, client_of, running_two, until
from tests.api.running_workers import linux, workers_of
from tests.postgres import Cluster
from tests.s3 import BUCKET, S3Server

pytestmark = pytest.mark.slow


@pytest.fixture
def servers(tmp_path: Path, postgres: Cluster, s3: S3Server) -> Iterator[tuple[Running, Running]]:
    """Serve one database and one bucket twice."""
    with running_two(tmp_path, postgres.new_database(), f"s3://{BUCKET}") as servers:
        yield servers


def test_a_clip_of_one_server_is_played_and_recognised_on_the_other(
    servers: tuple[Running, Running],
) -> None:
    one, two = servers
    clip = add_recorded_clip(one.studio, recording_of("circle"))
    assert not list(two.studio.clips.folder.iterdir())
    with client_of(two.address) as client:
        language = client.post(LANGUAGES, json={"name": "pool"}).json()["id"]
        add_gesture(client, language, clip)
        body = {"clip_id": clip, "language_id": language}
        answer = client.post("/api/v1/recognitions", json=body)
        assert answer.json()["label"] == "circle"
        part = client.get(f"{CLIPS}/{clip}/video", headers={"Range": "bytes=256-259"})
        assert (part.status_code, part.content) == (206, bytes(range(4)))
        assert client.get(f"{CLIPS}/{clip}/session.mcap").status_code == 200


def test_what_a_job_finds_is_read_on_the_other_server(
    servers: tuple[Running, Running], small_clip: Path, s3: S3Server, installed_models: None
) -> None:
    one, two = servers
    with client_of(one.address) as client:
        clip = upload(client, small_clip).json()["id"]
    with client_of(two.address) as client:
        until(lambda: client.get(f"{CLIPS}/{clip}").json()["status"] == "done")
        names = ("video", "recording.npz", "poster.jpg", "filmstrip.jpg")
        assert s3.names() == {f"{clip}/{name}" for name in names}
        assert client.get(f"{CLIPS}/{clip}/poster").headers["content-type"] == "image/jpeg"
        assert len(client.get(f"{CLIPS}/{clip}/poses").json()["time"]) == 12


def test_while_the_object_store_is_away_requests_are_asked_to_come_again(
    servers: tuple[Running, Running], small_clip: Path, s3: S3Server
) -> None:
    one, two = servers
    clip = add_recorded_clip(one.studio, recording_of("circle"))
    s3.stop()
    with client_of(two.address) as client:
        away = client.get(f"{CLIPS}/{clip}/video")
        assert_problem(away, 503, "store_unavailable")
        assert away.headers["retry-after"]
        assert_problem(upload(client, small_clip), 503, "store_unavailable")
        assert len(client.get(CLIPS).json()) == 1
        s3.start()
        assert len(client.get(f"{CLIPS}/{clip}/video").content) == 1024
        assert upload(client, small_clip).status_code == 202


@linux
def test_a_job_keeps_what_it_found_until_the_object_store_is_back(
    servers: tuple[Running, Running], small_clip: Path, s3: S3Server, installed_models: None
) -> None:
    with client_of(servers[0].address) as client:
        clip = upload(client, small_clip).json()["id"]
        until(lambda: workers_of(os.getpid()))
        s3.stop()
        # Either server may run the job.
        found = [server.studio.clips.place(clip, RECORDING) for server in servers]
        until(lambda: any(map(Path.is_file, found)) and not workers_of(os.getpid()))
        assert client.get(f"{CLIPS}/{clip}").json()["status"] == "running"
        s3.start()
        until(lambda: client.get(f"{CLIPS}/{clip}").json()["status"] == "done")
    for server in servers:
        assert len(httpx.get(f"{server.address}{CLIPS}/{clip}/poses").json()["time"]) == 12
