"""The health report over HTTP: once a revision, and not sent twice."""

import json
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest

from tests.api.running import Running, assert_problem
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line

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
    assert report["ok"] is not any(warning["below_bar"] for warning in report["warnings"])
    assert len(report["pairs"]) == 1
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


def test_an_older_revision_can_be_checked(client: httpx.Client, imported: str) -> None:
    client.patch(f"{LANGUAGES}/{imported}", json={"name": "sea"})
    older = client.get(f"{LANGUAGES}/{imported}/check", params={"revision": 1})
    assert older.json()["language"] == "pool"


def test_an_empty_language_is_not_ready(client: httpx.Client, language_id: str) -> None:
    report = client.get(f"{LANGUAGES}/{language_id}/check").json()
    assert report["ok"] is False
    assert report["warnings"][0]["code"] == "empty"


def test_a_language_that_is_not_there_is_404(client: httpx.Client) -> None:
    assert_problem(client.get(f"{LANGUAGES}/none/check"), 404, "not_found")


def test_a_check_tells_its_progress_and_can_be_cancelled_and_begun_anew(
    server: Running, client: httpx.Client, imported: str
) -> None:
    check = f"{LANGUAGES}/{imported}/check"
    with ThreadPoolExecutor() as pool, client.stream("GET", "/api/v1/events") as events:
        lines = events.iter_lines()
        next(lines)
        running = [pool.submit(httpx.get, server.address + check, timeout=60) for _ in range(2)]
        while next(lines) != "event: checks":
            pass
        told = json.loads(next(lines).removeprefix("data: "))
        assert told["id"] == imported
        assert told["stage"] == "rehearsing"
        assert 1 <= told["done"] <= told["total"]
        assert client.delete(check).status_code == 204
        for answer in running:
            assert_problem(answer.result(), 409, "check_cancelled")
    assert client.get(check).status_code == 200
