"""Status page: tells what the robot does, and to BlueOS and a health check whether it works."""

from __future__ import annotations

import http.client
import json
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, suppress
from typing import Any
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest

from app.cli.robots.channels import describe_event
from app.cli.robots.robot import open_page
from app.recognition.errors import PublishError
from app.robot import (
    FrameRateChanged,
    Heartbeat,
    SourceLost,
    SourceOpened,
    SourceRestored,
    VehicleReported,
)
from app.robot.publishing import status_page
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


def test_a_frame_rate_that_is_too_low_is_shown_until_it_is_enough(page: StatusPage) -> None:
    page.publish(FrameRateChanged(6.0, 2.0, False))
    assert status(page)["slow"] == "too slow for gestures: 2.0 frames a second"
    page.publish(FrameRateChanged(12.0, 5.0, True))
    assert status(page)["slow"] == ""


def test_what_the_vehicle_does_is_among_the_events(page: StatusPage) -> None:
    page.publish(VehicleReported(6.0, "done: surface"))
    assert [event["text"] for event in status(page)["events"]] == ["vehicle: done: surface"]


def test_a_robot_that_waits_says_for_what_and_is_well(page: StatusPage) -> None:
    page.publish(SourceOpened(0.0, "camera 0", True, (640, 480), None))
    page.wait_for("language.json is missing")
    assert status(page)["waits_for"] == "language.json is missing"
    page._heard -= 2 * SILENT_SECONDS
    assert fetch(page, "/healthz")[0] == 200


@pytest.mark.parametrize(
    ("host", "answer"),
    [
        ("127.0.0.1:9850", 200),
        ("192.168.2.2:9850", 200),
        ("[fe80::1]:9850", 200),
        ("localhost", 200),
        ("blueos.local", 200),
        ("BlueOS.local:80", 200),
        ("robot:9850", 200),
        ("evil.example", 403),
        ("192.168.2.2.evil.example:9850", 403),
        ("local.evil.example", 403),
        ("evil.example.", 403),
        ("evil@127.0.0.1", 403),
        ("127.0.0.1/evil", 403),
        ("[", 403),
        ("", 403),
    ],
)
@pytest.mark.parametrize("path", ["/", "/status.json"])
def test_a_page_of_another_name_cannot_read_it(
    page: StatusPage, host: str, answer: int, path: str
) -> None:
    connection = http.client.HTTPConnection("127.0.0.1", page.port, timeout=20)
    with closing(connection):
        connection.putrequest("GET", path, skip_host=True)
        connection.putheader("Host", host)
        connection.endheaders()
        assert connection.getresponse().status == answer


def test_requests_that_are_never_finished_hold_few_threads_and_end(
    page: StatusPage, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = threading.active_count()
    with ExitStack() as opened:
        stalled = [
            opened.enter_context(socket.create_connection(("127.0.0.1", page.port)))
            for _ in range(300)
        ]
        for each in stalled:
            with suppress(OSError):
                each.sendall(b"GET / HTTP/1.1\r\nX: ")
        assert fetch(page, "/healthz")[0] == 200
        wait_until(lambda: threading.active_count() <= before + status_page.MOST_CONNECTIONS)
        monkeypatch.setattr(status_page, "MOST_SECONDS", 0.0)
        wait_until(lambda: threading.active_count() <= before)
    monkeypatch.undo()
    assert fetch(page, "/healthz")[0] == 200


def wait_until(happens: Callable[[], bool]) -> None:
    """Wait until something happens; an error after a long time."""
    by = time.monotonic() + 20
    while not happens():
        assert time.monotonic() < by
        time.sleep(0.01)


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
