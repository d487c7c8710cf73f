"""The health report over HTTP: computed once per revision, and not sent twice."""

import json
import socket
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from typing import Any

import httpx
import pytest

from app.api.services.running_studio import Studio
from tests.api.languages import many_gestures
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import Running, assert_problem, until
from tests.conftest import ROOT
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line

pytestmark = pytest.mark.slow

LANGUAGES = "/api/v1/languages"


@pytest.fixture
def imported(client: httpx.Client) -> str:
    document = pool(circle=circle, line=line).to_json()
    answer = client.post(f"{LANGUAGES}/import", content=document)
    return str(answer.json()["id"])


def test_a_language_is_checked(client: httpx.Client, imported: str) -> None:
    answer = client.get(f"{LANGUAGES}/{imported}/check")
    assert answer.status_code == 200
    report = answer.json()
    assert report["ok"] is not any(warning["error"] for warning in report["warnings"])
    assert report["gestures"][0]["nearest"]["label"] == "line"
    assert report["forecast"]["right"] is None
    assert [gesture["label"] for gesture in report["gestures"]] == ["circle", "line"]


def test_the_newest_report_is_not_sent_twice(client: httpx.Client, imported: str) -> None:
    check = f"{LANGUAGES}/{imported}/check"
    tag = client.get(check).headers["etag"]
    again = client.get(check, headers={"If-None-Match": tag})
    assert again.status_code == 304
    assert again.content == b""
    client.patch(f"{LANGUAGES}/{imported}", json={"name": "sea"})
    changed = client.get(check, headers={"If-None-Match": tag})
    assert changed.status_code == 200
    assert changed.json()["language"] == "sea"


def test_a_demonstration_unlike_the_takes_of_the_test_set_is_named(
    client: httpx.Client, studio: Studio, language_id: str
) -> None:
    place = f"{LANGUAGES}/{language_id}"
    for label, shape in (("circle", "corner"), ("line", "line")):
        shown = {"label": label, "clip_id": add_recorded_clip(studio, recording_of(shape))}
        client.post(f"{place}/gestures", json=shown).raise_for_status()
    tag = client.get(f"{place}/check").headers["etag"]
    for shape in ("circle", "circle", "circle", "line", "line", "line"):
        take = {"clip_id": add_recorded_clip(studio, recording_of(shape)), "expected": shape}
        client.post(f"{place}/test-set", json={"takes": [take]}).raise_for_status()
    client.post(f"{place}/test-set/run").raise_for_status()
    report = client.get(f"{place}/check", headers={"If-None-Match": tag}).json()
    assert report["verdict"]["words"] == "1 error, circle 0 of 3"
    assert report["verdict"]["ready"] is False
    faults = [each for each in report["warnings"] if each["kind"] == "demonstration_fault"]
    assert [each["gestures"] for each in faults] == [["circle"]]
    assert faults[0]["message"] == (
        "Your demonstration of 'circle': up, where 3 of 3 takes have: clockwise loop."
    )


def test_an_older_revision_can_be_checked(client: httpx.Client, imported: str) -> None:
    client.patch(f"{LANGUAGES}/{imported}", json={"name": "sea"})
    older = client.get(f"{LANGUAGES}/{imported}/check", params={"revision": 1})
    assert older.json()["language"] == "pool"


def test_a_language_that_is_not_there_is_404(client: httpx.Client) -> None:
    assert_problem(client.get(f"{LANGUAGES}/none/check"), 404, "not_found")


def test_a_check_tells_its_progress_and_can_be_cancelled_and_begun_anew(
    server: Running, client: httpx.Client
) -> None:
    # Two hundred gestures: the check takes long enough for both requests to wait.
    document = json.loads((ROOT / "languages" / "osg-table-2.json").read_bytes())
    del document["sha256"], document["grammar"]
    document["gestures"] = [
        gesture | {"label": f"{gesture['label']} {turn}"}
        for turn in range(25)
        for gesture in document["gestures"]
    ]
    language = client.post(f"{LANGUAGES}/import?name=crowd", json=document).json()["id"]
    # Under another name: this process may already have the sample's report.
    client.patch(f"{LANGUAGES}/{language}", json={"name": "checked for the first time"})
    check = f"{LANGUAGES}/{language}/check"
    with ThreadPoolExecutor() as pool, client.stream("GET", "/api/v1/events") as events:
        lines = events.iter_lines()
        next(lines)
        for callers in (2, 1):
            running = [
                pool.submit(httpx.get, server.address + check, timeout=60) for _ in range(callers)
            ]
            progress = checks(lines)
            begun = next(each for each in progress if each["done"] == 1)
            later = list(islice(progress, 3))[-1]
            assert begun["id"] == later["id"] == language
            assert begun["stage"] == later["stage"] == "distances"
            assert 1 < later["done"] <= later["total"]
            assert client.delete(check).status_code == 204
            for answer in running:
                assert_problem(answer.result(), 409, "check_cancelled")


def checks(lines: Iterator[str]) -> Iterator[dict[str, Any]]:
    """Yield progress events of checks, as they come."""
    for written in lines:
        if written == "event: checks":
            yield json.loads(next(lines).removeprefix("data: "))


def begin_check(server: Running, language: str) -> socket.socket:
    """Request a check, and return the connection once it runs."""
    connection = socket.create_connection(("127.0.0.1", server.port))
    path = f"/api/v1/languages/{language}/check"
    connection.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
    until(lambda: server.studio.runner._runs)
    return connection


def test_a_check_whose_client_leaves_ends(server: Running, client: httpx.Client) -> None:
    document = (ROOT / "languages" / "osg-table-2.json").read_bytes()
    language = client.post(f"{LANGUAGES}/import", content=document).json()["id"]
    client.patch(f"{LANGUAGES}/{language}", json={"name": "checked and left"})
    with begin_check(server, language):
        folder = server.studio.clips.folder
        until(lambda: list(folder.glob(".unpacked-*")))
    until(lambda: not server.studio.runner._runs)
    until(lambda: not list(folder.glob(".unpacked-*")))


def test_a_check_of_many_gestures_leaves_the_server_free(
    server: Running, client: httpx.Client
) -> None:
    document = many_gestures(300)
    language = client.post(f"{LANGUAGES}/import", content=document).json()["id"]
    with begin_check(server, language):
        for _ in range(20):
            assert client.get("/healthz", timeout=5).status_code == 200
    until(lambda: not server.studio.runner._runs)
