"""Open connections end within seconds once their token or session is not valid any more."""

from __future__ import annotations

import json
import logging
import shutil
import socket
import sqlite3
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, suppress
from pathlib import Path
from threading import Event
from typing import Any

import httpx
import pytest
import viser
from pydantic import SecretStr
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.sync.connection import Connection
from websockets.typing import Subprotocol

from app.api.http.websockets import POLICY_VIOLATION
from app.api.middleware import open_connections
from app.api.middleware.access import COOKIE
from app.settings import Settings
from app.store import Role, TokenFile
from tests.api.invitations import invite, token_of
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import Running, assert_problem, client_of, running
from tests.robot.languages import language_of

API = "/api/v1"
OWN = "correct-horse-battery"
TUS = {"Tus-Resumable": "1.0.0"}

CUT_OFF = (httpx.RemoteProtocolError, httpx.ReadError)
"""How a client learns that its stream was cut off; a time-out is none of them."""

CLIP_BYTES = 64 * 1024 * 1024
"""Bytes of a video that no socket holds: much of it is still to be sent when a client pauses."""


@pytest.fixture(autouse=True)
def watched_often(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a server look ten times a second whether open connections are still allowed."""
    monkeypatch.setattr(open_connections, "WATCH_SECONDS", 0.1)


@pytest.fixture
def guarded(settings: Settings) -> Iterator[Running]:
    """Return a server with a token of its settings; named ones come while it runs."""
    with running(settings.model_copy(update={"token": SecretStr(OWN)})) as server:
        yield server


@pytest.fixture
def tokens(settings: Settings) -> TokenFile:
    return TokenFile(settings.tokens)


def bearer(token: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {token}"}


def listen(stream: httpx.Response) -> Iterator[str]:
    """Return the lines of an event stream that has begun."""
    lines = stream.iter_lines()
    while "listening" not in next(lines):
        pass
    return lines


def read_to_the_end(lines: Iterator[str]) -> None:
    """Read a stream until the server ends it; fail if it does not."""
    with suppress(*CUT_OFF):
        for _ in lines:
            pass


def withdraw(tokens: TokenFile, _settings: Settings) -> None:
    tokens.remove("Ada")


def damage_the_list(_tokens: TokenFile, settings: Settings) -> None:
    settings.tokens.write_text("{")


def replace_the_token(tokens: TokenFile, _settings: Settings) -> None:
    tokens.add("Ada", Role.READ)


@pytest.mark.withstands(row="H30")
@pytest.mark.parametrize(
    "end",
    [
        withdraw,
        damage_the_list,
        replace_the_token,
    ],
)
def test_an_event_stream_ends_with_its_token(
    guarded: Running,
    tokens: TokenFile,
    settings: Settings,
    end: Callable[[TokenFile, Settings], None],
    caplog: pytest.LogCaptureFixture,
) -> None:
    address = f"{guarded.address}{API}/events"
    secret = tokens.add("Ada", Role.READ)
    with httpx.stream("GET", address, headers=bearer(secret), timeout=60) as stream:
        lines = listen(stream)
        end(tokens, settings)
        read_to_the_end(lines)
    assert [each for each in caplog.records if each.name == "uvicorn.error"] == []
    assert httpx.get(address, headers=bearer(secret)).status_code in (401, 503)


def test_the_streams_of_others_go_on(guarded: Running, tokens: TokenFile) -> None:
    address = f"{guarded.address}{API}/events"
    secrets = [tokens.add("Ada", Role.READ), tokens.add("Bo", Role.READ), OWN]
    with (
        httpx.stream("GET", address, headers=bearer(secrets[0]), timeout=60) as one,
        httpx.stream("GET", address, headers=bearer(secrets[1]), timeout=60) as two,
        httpx.stream("GET", address, headers=bearer(secrets[2]), timeout=60) as three,
    ):
        ended, *others = listen(one), listen(two), listen(three)
        tokens.remove("Ada")
        read_to_the_end(ended)
        made = httpx.post(
            f"{guarded.address}{API}/languages", json={"name": "pool"}, headers=bearer(OWN)
        )
        assert made.status_code == 201
        for lines in others:
            assert made.json()["id"] in next(line for line in lines if line.startswith("data:"))


@pytest.mark.withstands(row="H30")
def test_a_log_out_ends_the_session_with_its_streams_and_copies_of_its_cookie(
    guarded: Running, tokens: TokenFile
) -> None:
    secret = tokens.add("Ada", Role.READ)
    with client_of(guarded.address) as browser, client_of(guarded.address) as other:
        for each in (browser, other):
            assert each.get("/", params={"token": secret}).status_code == 303
        copied = {COOKIE: browser.cookies[COOKIE]}
        with browser.stream("GET", f"{API}/events") as stream:
            lines = listen(stream)
            assert browser.delete(f"{API}/session").status_code == 204
            read_to_the_end(lines)
        answer = httpx.get(f"{guarded.address}{API}/session", cookies=copied)
        assert_problem(answer, 401, "token_required")
        # The token's other session, and the token, are still valid.
        assert other.get(f"{API}/session").json()["name"] == "Ada"


def test_streams_outlast_a_database_that_does_not_answer(
    guarded: Running, settings: Settings, tokens: TokenFile
) -> None:
    secret = tokens.add("Ada", Role.EDIT)
    with client_of(guarded.address) as browser:
        browser.get("/", params={"token": secret})
        with browser.stream("GET", f"{API}/events") as stream:
            lines = listen(stream)
            with closing(sqlite3.connect(settings.data_dir / "studio.db")) as database:
                database.execute("ALTER TABLE sign_in RENAME TO away")
                answer: dict[str, object] = {}
                while answer.get("status") != 503:
                    answer = browser.get(f"{API}/session").json()
                database.execute("ALTER TABLE away RENAME TO sign_in")
            made = browser.post(f"{API}/languages", json={"name": "pool"})
            assert made.json()["id"] in next(line for line in lines if line.startswith("data:"))


@pytest.fixture
def follow(guarded: Running) -> Iterator[Callable[[str, str], Connection]]:
    """Return a function that opens a websocket with a token."""
    opened: list[Connection] = []

    def open_websocket(path: str, secret: str) -> Connection:
        address = guarded.address.replace("http", "ws") + path
        opened.append(
            connect(
                address,
                subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
                additional_headers=bearer(secret),
                proxy=None,
                ping_interval=None,
            )
        )
        return opened[-1]

    yield open_websocket
    for each in opened:
        each.close()


@pytest.mark.withstands(row="H30")
@pytest.mark.parametrize("path", [f"{API}/workspaces/{{}}/playback", "/viser/{}"])
def test_websockets_of_a_workspace_end_with_the_token(
    guarded: Running, tokens: TokenFile, follow: Callable[[str, str], Connection], path: str
) -> None:
    secret = tokens.add("Ada", Role.READ)
    with client_of(guarded.address, headers=bearer(secret)) as client:
        opened = client.post(f"{API}/workspaces").json()["id"]
    websocket = follow(path.format(opened), secret)
    websocket.recv(timeout=60)
    tokens.remove("Ada")
    with pytest.raises(ConnectionClosed) as closed:
        deque(iter(websocket.recv, None), maxlen=0)
    assert closed.value.rcvd is not None
    assert (closed.value.rcvd.code, closed.value.rcvd.reason) == (
        POLICY_VIOLATION,
        "token_required",
    )


def test_a_download_is_cut_off_with_the_token(
    guarded: Running, tokens: TokenFile, tmp_path: Path
) -> None:
    clip_id = add_recorded_clip(guarded.studio, recording_of("circle"))
    with guarded.studio.clips.video(clip_id).open("wb") as video:
        video.truncate(CLIP_BYTES)
    secret = tokens.add("Ada", Role.READ)
    address = f"{guarded.address}{API}"
    with (
        httpx.stream("GET", f"{address}/events", headers=bearer(secret), timeout=60) as stream,
        httpx.stream(
            "GET", f"{address}/clips/{clip_id}/video", headers=bearer(secret), timeout=60
        ) as download,
    ):
        events = listen(stream)
        assert int(download.headers["content-length"]) == CLIP_BYTES
        pieces = download.iter_raw()
        next(pieces)
        tokens.remove("Ada")
        # A paused player reads nothing until a stream of the same token has ended.
        read_to_the_end(events)
        with pytest.raises(CUT_OFF):
            deque(pieces, maxlen=0)


@pytest.mark.withstands(row="H30")
@pytest.mark.parametrize("role", [None, Role.READ])
def test_an_upload_is_refused_in_mid_body_with_the_token_or_the_role(
    guarded: Running, tokens: TokenFile, settings: Settings, role: Role | None
) -> None:
    secret = tokens.add("Ada", Role.EDIT)
    with client_of(guarded.address, headers=bearer(secret) | TUS) as client:
        place = client.post(f"{API}/uploads", headers={"Upload-Length": "100000"}).headers[
            "location"
        ]
    headers = bearer(secret) | TUS | {"Upload-Offset": "0", "Content-Length": "100000"}
    headers |= {"Host": "localhost", "Expect": "100-continue"}
    headers |= {"Content-Type": "application/offset+octet-stream"}
    lines = [f"PATCH {place} HTTP/1.1", *(f"{name}: {value}" for name, value in headers.items())]
    with socket.create_connection(("127.0.0.1", guarded.port), timeout=60) as connection:
        connection.sendall("\r\n".join([*lines, "", ""]).encode())
        assert b"100 Continue" in connection.recv(4096)
        connection.sendall(b"x" * 1000)
        if role is None:
            tokens.remove("Ada")
        else:
            document = json.loads(settings.tokens.read_text())
            document["tokens"][0]["role"] = role.value
            settings.tokens.write_text(json.dumps(document))
        answer = b"".join(iter(lambda: connection.recv(4096), b"")).decode()
    assert answer.startswith("HTTP/1.1 401 ")
    assert "connection: close" in answer.lower()
    assert '"code":"token_required"' in answer
    # What arrived is kept for who may go on.
    with client_of(guarded.address, headers=bearer(OWN) | TUS) as admin:
        assert admin.head(place).headers["upload-offset"] == "1000"


def test_an_invited_upload_is_refused_in_mid_body_with_the_invitation(guarded: Running) -> None:
    with client_of(guarded.address, headers=bearer(OWN)) as owner:
        content = language_of("circle").to_json()
        language = owner.post(f"{API}/languages/import", content=content).json()["id"]
        made = invite(owner, language)
        head = (
            f"POST {API}/invited/takes?label=circle&diver=Bo HTTP/1.1\r\nHost: localhost\r\n"
            f"Authorization: Bearer {token_of(made)}\r\nContent-Length: 100000\r\n"
            "Content-Type: multipart/form-data; boundary=x\r\nExpect: 100-continue\r\n\r\n"
        )
        with socket.create_connection(("127.0.0.1", guarded.port), timeout=60) as connection:
            connection.sendall(head.encode())
            assert b"100 Continue" in connection.recv(4096)
            connection.sendall(b'--x\r\nContent-Disposition: form-data; name="label"\r\n\r\n')
            owner.delete(f"{API}/languages/{language}/invitations/{made['id']}")
            answer = b"".join(iter(lambda: connection.recv(4096), b"")).decode()
    assert answer.startswith("HTTP/1.1 403 ")
    assert '"code":"invitation_closed"' in answer


def test_what_was_computed_meanwhile_is_not_shown(
    guarded: Running, tokens: TokenFile, monkeypatch: pytest.MonkeyPatch
) -> None:
    secret = tokens.add("Ada", Role.READ)
    listing, withdrawn = Event(), Event()
    entries = guarded.studio.languages.all

    def list_slowly(*given: Any) -> Any:
        listing.set()
        assert withdrawn.wait(60)
        return entries(*given)

    monkeypatch.setattr(guarded.studio.languages, "all", list_slowly)
    with (
        ThreadPoolExecutor(1) as asking,
        httpx.stream(
            "GET", f"{guarded.address}{API}/events", headers=bearer(secret), timeout=60
        ) as stream,
    ):
        lines = listen(stream)
        answer = asking.submit(
            httpx.get, f"{guarded.address}{API}/languages", headers=bearer(secret), timeout=60
        )
        assert listing.wait(60)
        tokens.remove("Ada")
        read_to_the_end(lines)
        withdrawn.set()
        assert_problem(answer.result(), 401, "token_required")


def test_who_came_before_there_were_tokens_is_shut_out_too(settings: Settings) -> None:
    with (
        running(settings) as server,
        httpx.stream("GET", f"{server.address}{API}/events", timeout=60) as stream,
    ):
        lines = listen(stream)
        TokenFile(settings.tokens).add("Ada", Role.ADMIN)
        read_to_the_end(lines)
        assert_problem(httpx.get(f"{server.address}{API}/languages"), 401, "token_required")


def test_unmounting_and_mounting_the_list_costs_nobody_the_session(
    settings: Settings, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.CRITICAL)
    share, away = tmp_path / "share", tmp_path / "away"
    named = settings.model_copy(update={"tokens_file": share / "tokens.json"})
    secret = TokenFile(named.tokens).add("Ada", Role.READ)
    with running(named) as server, client_of(server.address) as browser:
        browser.get("/", params={"token": secret})
        shutil.move(share, away)
        assert_problem(browser.get(f"{API}/session"), 401, "token_required")
        shutil.move(away, share)
        assert browser.get(f"{API}/session").json()["name"] == "Ada"
