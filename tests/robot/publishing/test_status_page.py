"""Status page: tells what the robot does, and to BlueOS and a health check whether it works."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import closing
from typing import Any
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest

from app.cli.robots.events import describe_event
from app.cli.robots.robot import open_page
from app.recognition.errors import PublishError
from app.robot import Heartbeat, SourceLost, SourceOpened, SourceRestored
from app.robot.publishing.status_page import MOST_EVENTS, SILENT_SECONDS, StatusPage
from app.robot.runtime import build_language_changed
from tests.robot.languages import spoken


@pytest.fixture
def page() -> Iterator[StatusPage]:
    with closing(StatusPage("127.0.0.1", 0, describe_event)) as served:
        yield served


def fetch(page: StatusPage, path: str) -> tuple[int, bytes]:
    try:
        with urlopen(f"http://127.0.0.1:{page.port}{path}") as answer:
            return answer.status, answer.read()
    except HTTPError as error:
        return error.code, error.read()


def status(page: StatusPage) -> dict[str, Any]:
    content: dict[str, Any] = json.loads(fetch(page, "/status.json")[1])
    return content


def test_it_shows_camera_language_and_events(page: StatusPage) -> None:
    page.publish(SourceOpened(0.0, "camera 0", True, (640, 480), None))
    page.publish(build_language_changed(0.0, spoken("circle")))
    page.publish(SourceLost(2.0, "unplugged"))
    shown = status(page)
    assert shown["source"] == "camera 0"
    assert shown["language"]["code"] == build_language_changed(0.0, spoken("circle")).code
    assert shown["lost"]
    assert [event["event"] for event in shown["events"]] == [
        "source_opened",
        "language_changed",
        "source_lost",
    ]
    page.publish(SourceRestored(3.0, 1.0, 1))
    assert not status(page)["lost"]


def test_a_live_robot_that_falls_silent_does_not_work(
    page: StatusPage, monkeypatch: pytest.MonkeyPatch
) -> None:
    page.publish(SourceOpened(0.0, "camera 0", True, (640, 480), None))
    assert fetch(page, "/healthz") == (200, b'{"works": true}')
    before = time.monotonic()
    monkeypatch.setattr(time, "monotonic", lambda: before + SILENT_SECONDS + 1)
    assert fetch(page, "/healthz") == (503, b'{"works": false}')
    page.publish(Heartbeat(40.0, 100, 0, False))
    assert fetch(page, "/healthz")[0] == 200


def test_old_events_are_forgotten(page: StatusPage) -> None:
    for second in range(2 * MOST_EVENTS):
        page.publish(SourceLost(float(second), "unplugged"))
    assert [event["time"] for event in status(page)["events"]] == [
        float(second) for second in range(MOST_EVENTS, 2 * MOST_EVENTS)
    ]


def test_the_page_loads_nothing_from_elsewhere(page: StatusPage) -> None:
    code, html = fetch(page, "/")
    assert code == 200
    assert b"://" not in html
    assert b'fetch("status.json")' in html
    assert fetch(page, "/../events.py")[0] == 404


def test_blueos_finds_a_service_in_it(page: StatusPage) -> None:
    service = json.loads(fetch(page, "/register_service")[1])
    texts = ("name", "description", "icon", "company", "version", "webpage", "api")
    assert all(isinstance(service[key], str) for key in texts)
    assert service["icon"].startswith("mdi-")
    assert service["works_in_relative_paths"] is True


@pytest.mark.parametrize("address", ["", "here", "1:2:x", "127.0.0.1:99999"])
def test_a_wrong_address_is_one_line(address: str) -> None:
    with pytest.raises(PublishError, match=r"is no place for the page|cannot be served at"):
        open_page(address)


def test_a_port_that_is_taken_is_one_line(page: StatusPage) -> None:
    with pytest.raises(PublishError, match="cannot be served at"):
        open_page(str(page.port))
