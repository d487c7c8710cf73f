"""Work for a client ends when the client disconnects, in threads too."""

import json
import socket
import threading
from collections.abc import Coroutine
from typing import Any
from urllib.parse import urlencode

import httpx
import pytest
from starlette.requests import Request

from app.api.http.connection import while_connected
from app.api.routes.gestures import previews
from app.api.routes.languages import checks
from app.api.services import limited_routes
from app.api.services.limited_routes import MOST_COMPUTATIONS
from app.recognition import Language
from app.recognition.explanation.alignment import compare_pair
from app.recognition.recognizer import Recognizer
from tests.api.languages import LANGUAGES
from tests.api.running import Running, until
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line


@pytest.fixture
def language(client: httpx.Client) -> str:
    document = pool(circle=circle, line=line).to_json()
    return str(client.post(f"{LANGUAGES}/import", content=document).json()["id"])


def begin(server: Running, method: str, path: str, body: bytes = b"") -> socket.socket:
    opened = socket.create_connection(("127.0.0.1", server.port))
    head = f"{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n"
    head += f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
    opened.sendall(head.encode() + body)
    return opened


def test_a_preview_ends_when_its_client_leaves(
    server: Running, client: httpx.Client, language: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    began, left, compared = threading.Event(), threading.Event(), threading.Event()

    def prepare(language: Language, profile: str) -> Recognizer:
        began.set()
        left.wait(60)  # what takes minutes on a slow machine
        return Recognizer(language, profile)

    async def wait(request: Request, work: Coroutine[Any, Any, Any]) -> Any:
        try:
            return await while_connected(request, work)
        finally:
            left.set()

    def compare(*_: object) -> list[tuple[str, float]]:
        compared.set()
        return []

    monkeypatch.setattr(previews, "Recognizer", prepare)
    monkeypatch.setattr(previews, "rank_others", compare)
    monkeypatch.setattr(limited_routes, "while_connected", wait)
    body = json.dumps({"label": "circle", "change": {}}).encode()
    with begin(server, "POST", f"{LANGUAGES}/{language}/preview/health", body):
        until(began.is_set)
    until(lambda: server.studio.turns.computations._value == MOST_COMPUTATIONS)
    assert not compared.is_set()
    monkeypatch.undo()
    again = client.post(f"{LANGUAGES}/{language}/preview/health", json=json.loads(body))
    assert again.status_code == 200


def test_a_pair_difference_ends_when_its_client_leaves_and_keeps_its_place_until_then(
    server: Running, language: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    began, left, go_on = threading.Event(), threading.Event(), threading.Event()
    compared = []

    def compare(recognizer: Recognizer, first: int, second: int) -> object:
        compared.append((first, second))
        began.set()
        go_on.wait(60)
        return compare_pair(recognizer, first, second)

    async def wait(request: Request, work: Coroutine[Any, Any, Any]) -> Any:
        try:
            return await while_connected(request, work)
        finally:
            left.set()

    monkeypatch.setattr(checks, "compare_pair", compare)
    monkeypatch.setattr(limited_routes, "while_connected", wait)
    query = urlencode({"one": "circle", "other": "line"})
    with begin(server, "GET", f"{LANGUAGES}/{language}/contrast?{query}"):
        until(began.is_set)
        assert server.studio.turns.computations._value < MOST_COMPUTATIONS
    until(left.is_set)
    assert server.studio.turns.computations._value < MOST_COMPUTATIONS
    go_on.set()
    until(lambda: server.studio.turns.computations._value == MOST_COMPUTATIONS)
    assert compared == [(0, 1)]
