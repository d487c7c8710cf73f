"""Playback over the websocket: one client's commands are executed and sent to all."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.sync.client import connect
from websockets.sync.connection import Connection
from websockets.typing import Origin

from app.api.http.websockets import UNSUPPORTED_DATA
from tests.api.running import Running


@pytest.fixture
def workspace_id(client: httpx.Client, circle_clip: str) -> str:
    """Return the id of a workspace that shows a clip."""
    opened = str(client.post("/api/v1/workspaces").json()["id"])
    view = {"clip_id": circle_clip, "start": 1.0, "end": 2.0}
    assert client.put(f"/api/v1/workspaces/{opened}/view", json=view).status_code == 204
    return opened


@contextmanager
def clock_of(server: Running, workspace_id: str, origin: str | None = None) -> Iterator[Connection]:
    address = server.address.replace("http", "ws")
    with connect(
        f"{address}/api/v1/workspaces/{workspace_id}/playback",
        origin=None if origin is None else Origin(origin),
        proxy=None,
        open_timeout=60,
        ping_interval=None,
    ) as connection:
        yield connection


def position(clock: Connection, **wanted: object) -> dict[str, Any]:
    """Wait for a position with these values, and return all of it."""
    while True:
        position: dict[str, Any] = json.loads(clock.recv(timeout=60))
        if wanted.items() <= position.items():
            return position


def test_who_follows_is_told_where_the_clock_stands(
    server: Running, workspace_id: str, client: httpx.Client, circle_clip: str
) -> None:
    times = client.get(f"/api/v1/clips/{circle_clip}/timeline").json()["time"]
    with clock_of(server, workspace_id) as clock:
        first = position(clock)
        assert first["frames"] == len(times)
        assert 1.0 <= first["time"] <= 2.0
        for frame in (0, 40, len(times) - 1):
            clock.send(json.dumps({"do": "seek", "frame": frame}))
            assert position(clock, frame=frame)["time"] == pytest.approx(times[frame])
        clock.send(json.dumps({"do": "step", "frames": -10}))
        position(clock, frame=len(times) - 11, playing=False)


def test_playing_and_looping_are_told(server: Running, workspace_id: str) -> None:
    with clock_of(server, workspace_id) as clock, clock_of(server, workspace_id) as other:
        clock.send(json.dumps({"do": "play", "speed": -0.5}))
        position(other, playing=True, speed=-0.5)
        clock.send(json.dumps({"do": "loop", "on": False}))
        position(other, loop=False)
        other.send(json.dumps({"do": "play", "speed": 0}))
        position(clock, playing=False)


@pytest.mark.parametrize(
    "message",
    ["", "[]", '{"do": "format"}', '{"do": "seek", "frame": -1}', '{"do": "play", "speed": 1e9}'],
)
def test_what_is_no_wish_ends_the_connection(
    server: Running, workspace_id: str, message: str
) -> None:
    with clock_of(server, workspace_id) as clock:
        clock.send(message)
        with pytest.raises(ConnectionClosed) as closed:
            position(clock, frame="never")
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == UNSUPPORTED_DATA


def test_there_is_no_clock_without_a_workspace(server: Running) -> None:
    with pytest.raises(InvalidHandshake), clock_of(server, "nothing") as clock:
        position(clock)
