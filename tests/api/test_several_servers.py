"""Two servers on one PostgreSQL and one folder of clips: both give a browser the same answers."""

from __future__ import annotations

import json
import os
from collections import deque
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from datetime import timedelta
from pathlib import Path
from threading import Barrier
from typing import Any

import httpx
import pytest

from app.store import Clip, ClipStore, Role, TokenFile
from app.store.jobs import JobStore
from tests.api.languages import LANGUAGES
from tests.api.routes.clips.test_clips import upload
from tests.api.running import Running, assert_problem, client_of, running_two, until
from tests.api.running_workers import linux, workers_of
from tests.postgres import Cluster
from tests.recognition.damaged_clips import write_clip

JOBS = "/api/v1/jobs"


@pytest.fixture
def servers(tmp_path: Path, postgres: Cluster) -> Iterator[tuple[Running, Running]]:
    """Serve one database and one folder of clips twice, for anybody."""
    with running_two(tmp_path, postgres.new_database(), tmp_path / "clips") as servers:
        yield servers


@pytest.fixture
def guarded(tmp_path: Path, postgres: Cluster, jo: str) -> Iterator[tuple[Running, Running]]:
    """Serve the same twice, for those with a token of the list that both read."""
    with running_two(tmp_path, postgres.new_database(), tmp_path / "clips") as servers:
        yield servers


@pytest.fixture
def tokens(tmp_path: Path) -> TokenFile:
    return TokenFile(tmp_path / "tokens.json")


@pytest.fixture
def jo(tokens: TokenFile) -> str:
    """Return a token that was there before the servers were started."""
    return tokens.add("Jo", Role.EDIT)


@contextmanager
def events(server: Running) -> Iterator[Iterator[tuple[str, dict[str, Any]]]]:
    """Follow the events of a server."""
    with httpx.stream("GET", f"{server.address}/api/v1/events", timeout=60) as stream:
        lines = stream.iter_lines()
        while "listening" not in next(lines):
            pass

        def read() -> Iterator[tuple[str, dict[str, Any]]]:
            kind = ""
            for line in lines:
                kind = line.removeprefix("event:").strip() if line.startswith("event:") else kind
                if line.startswith("data:"):
                    yield kind, json.loads(line.removeprefix("data:"))

        yield read()


@pytest.mark.slow
def test_a_change_on_one_server_reaches_the_pages_and_lists_of_the_other(
    servers: tuple[Running, Running],
) -> None:
    one, two = servers
    with client_of(two.address) as client:
        empty = client.get(LANGUAGES)
        assert empty.json() == []
        with events(two) as heard:
            made = httpx.post(f"{one.address}{LANGUAGES}", json={"name": "pool"}).json()
            assert next(heard) == ("languages", {"id": made["id"]})
        listed = client.get(LANGUAGES, headers={"If-None-Match": empty.headers["etag"]})
        assert [each["name"] for each in listed.json()] == ["pool"]
        tag = {"If-None-Match": listed.headers["etag"]}
        assert httpx.get(f"{one.address}{LANGUAGES}", headers=tag).status_code == 304
        stale = client.patch(f"{LANGUAGES}/{made['id']}", json={"name": "sea"})
        assert stale.status_code == 200
        answer = httpx.patch(
            f"{one.address}{LANGUAGES}/{made['id']}",
            json={"name": "lake"},
            headers={"If-Match": '"1"'},
        )
        assert answer.status_code == 412


@pytest.mark.slow
@linux
def test_a_job_is_seen_and_cancelled_from_any_server(
    servers: tuple[Running, Running], tmp_path: Path
) -> None:
    one, two = servers
    clip = write_clip(tmp_path / "long.mp4", frames=2000)
    with client_of(two.address) as client:
        job_id = upload(client_of(one.address), clip).json()["job_id"]
        until(lambda: workers_of(os.getpid()))
        (worker,) = workers_of(os.getpid())
        until(lambda: client.get(f"{JOBS}/{job_id}").json()["stage"] in ("starting", "poses"))
        running_here = one if job_id in one.studio.extractions._running else two
        elsewhere = two if running_here is one else one
        with client_of(elsewhere.address) as other:
            assert other.get(f"{JOBS}/{job_id}").json()["stage"] != "running"
            assert other.delete(f"{JOBS}/{job_id}").json()["status"] == "cancelled"
        until(lambda: worker not in workers_of(os.getpid()))
        assert client.get(f"{JOBS}/{job_id}").json()["status"] == "cancelled"


@pytest.mark.slow
@linux
def test_the_job_of_a_server_that_vanished_is_run_by_the_other(
    servers: tuple[Running, Running], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one, two = servers
    monkeypatch.setattr("app.api.jobs.extraction_queue.RENEW_SECONDS", 0.2)
    partial = one.studio.clips.new_partial()
    write_clip(tmp_path / "clip.mp4", frames=3).rename(partial)
    clip = Clip(name="dive", media_type="video/mp4", size=5, width=64, height=48)
    job_id = one.studio.clips.add(clip, partial, "diver").job.id
    # A third server began the job and then lost its power.
    with monkeypatch.context() as vanishing:
        vanishing.setattr("app.store.jobs.LEASE", timedelta(seconds=-2))
        assert JobStore(one.studio.jobs._database, "vanished").start(job_id) is not None
    for server in servers:
        loop = server.studio.broadcast._loop
        loop.call_soon_threadsafe(server.studio.extractions.look)
    with client_of(two.address) as client:
        until(lambda: client.get(f"{JOBS}/{job_id}").json()["status"] in ("done", "failed"))
    assert one.studio.jobs.get(job_id).attempts == 2


@pytest.mark.slow
def test_uploads_to_two_servers_at_the_same_time_share_one_quota(
    guarded: tuple[Running, Running],
    small_clip: Path,
    tokens: TokenFile,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    together = Barrier(2)

    def add(store: ClipStore, *clip: Any, **upload: Any) -> Any:
        # Both uploads passed the first check of the quota, which has room for one clip.
        together.wait(60)
        return add_clip(store, *clip, **upload)

    add_clip = ClipStore.add
    monkeypatch.setattr(ClipStore, "add", add)
    secret = tokens.add("Jo", Role.EDIT, quota_clips=1)
    headers = {"Authorization": f"Bearer {secret}"}

    def send(server: Running) -> int:
        with client_of(server.address, headers=headers) as client:
            return upload(client, small_clip).status_code

    with ThreadPoolExecutor(2) as uploaders:
        assert sorted(uploaders.map(send, guarded)) == [202, 507]
    assert len(guarded[0].studio.clips.all()) == 1
    # The refused upload left nothing behind.
    (kept,) = guarded[0].studio.clips.folder.iterdir()
    assert kept.name == guarded[0].studio.clips.all()[0].clip.id


@pytest.mark.slow
def test_an_upload_that_one_server_receives_counts_on_the_other(
    guarded: tuple[Running, Running], small_clip: Path, tokens: TokenFile
) -> None:
    one, two = guarded
    content = small_clip.read_bytes()
    secret = tokens.add("Jo", Role.EDIT, quota_bytes=len(content))
    headers = {"Authorization": f"Bearer {secret}", "Tus-Resumable": "1.0.0"}
    length = {"Upload-Length": str(len(content))}
    part = {"Upload-Offset": "0", "Content-Type": "application/offset+octet-stream"}
    with (
        client_of(one.address, headers=headers) as first,
        client_of(two.address, headers=headers) as second,
    ):
        given_up = first.post("/api/v1/uploads", headers=length).headers["location"]
        assert_problem(second.post("/api/v1/uploads", headers=length), 507, "quota_exceeded")
        assert_problem(upload(second, small_clip), 507, "quota_exceeded")
        assert first.delete(given_up).status_code == 204
        begun = second.post("/api/v1/uploads", headers=length).headers["location"]
        assert_problem(upload(first, small_clip), 507, "quota_exceeded")
        # An upload's own reserved space must not keep it from becoming a clip.
        assert second.patch(begun, headers=part, content=content).status_code == 204
        usage = one.studio.quotas.usage("Jo")
        assert (usage.clips, usage.bytes) == (1, len(content))


@pytest.mark.slow
def test_a_session_is_valid_on_both_servers_until_a_log_out_on_one(
    guarded: tuple[Running, Running], jo: str
) -> None:
    one, two = guarded
    with client_of(one.address) as browser:
        assert browser.get("/", params={"token": jo}).status_code == 303
        cookies = dict(browser.cookies)
        elsewhere = f"{two.address}/api/v1/session"
        assert httpx.get(elsewhere, cookies=cookies).json()["name"] == "Jo"
        address = f"{two.address}/api/v1/events"
        with httpx.stream("GET", address, cookies=cookies, timeout=60) as stream:
            lines = stream.iter_lines()
            assert "listening" in next(lines)
            assert browser.delete("/api/v1/session").status_code == 204
            # The stream on the other server ends, whole or cut off; a time-out would fail.
            with suppress(httpx.RemoteProtocolError, httpx.ReadError):
                deque(lines, maxlen=0)
        until(lambda: httpx.get(elsewhere, cookies=cookies).status_code == 401)
        assert httpx.get(elsewhere, headers={"Authorization": f"Bearer {jo}"}).status_code == 200


@pytest.mark.slow
def test_a_list_of_tokens_that_is_not_there_lets_nobody_in_on_both_servers(
    guarded: tuple[Running, Running], jo: str, tmp_path: Path
) -> None:
    bearer = {"Authorization": f"Bearer {jo}"}
    (tmp_path / "tokens.json").rename(tmp_path / "away.json")
    for server in guarded:
        for headers in ({}, bearer):
            answer = httpx.get(f"{server.address}{LANGUAGES}", headers=headers)
            assert_problem(answer, 401, "token_required")
    (tmp_path / "away.json").rename(tmp_path / "tokens.json")
    for server in guarded:
        assert httpx.get(f"{server.address}{LANGUAGES}", headers=bearer).status_code == 200
