"""The live view: a camera's frames go in, landmarks and recognised takes come out."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import av
import cv2
import httpx
import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.sync.client import connect
from websockets.sync.connection import Connection
from websockets.typing import Origin, Subprotocol

from app.api.http.websockets import POLICY_VIOLATION, UNSUPPORTED_DATA
from app.api.live.frame_pipeline import decode_frame
from app.api.live.socket import (
    INVITED_PROTOCOL,
    MESSAGE_TOO_BIG,
    MOST_VIEWS,
    TRY_AGAIN_LATER,
)
from app.recognition.errors import VideoError
from app.recognition.poses.frame import Image
from app.settings import Settings
from tests.api.invitations import invite, token_of
from tests.api.running import Running, until
from tests.conftest import ROOT

pytestmark = pytest.mark.usefixtures("installed_models")

EVERY = 3
"""One frame of a 25 Hz clip out of this many is sent: what a slow machine can process."""


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    """Return settings with the sample languages that we ship."""
    return Settings(data_dir=tmp_path / "data", samples_dir=ROOT / "languages")


def jpeg_of(image: Image) -> bytes:
    done, encoded = cv2.imencode(".jpg", image[..., ::-1])
    assert done
    return encoded.tobytes()


def message_of(time: float, jpeg: bytes) -> bytes:
    return struct.pack("<d", time) + jpeg


def frames_of(clip: Path) -> Iterator[tuple[float, bytes]]:
    with av.open(str(clip)) as container:
        for index, frame in enumerate(container.decode(video=0)):
            if index % EVERY == 0:
                assert frame.time is not None
                yield frame.time, jpeg_of(frame.to_ndarray(format="rgb24").astype(np.uint8))


@contextmanager
def live(
    server: Running, origin: str | None = None, invited: str | None = None
) -> Iterator[Connection]:
    """Open a live view, or with the token of an invitation its own."""
    address = server.address.replace("http", "ws")
    with connect(
        f"{address}/api/v1{'' if invited is None else '/invited'}/live",
        origin=None if origin is None else Origin(origin),
        subprotocols=None
        if invited is None
        else [Subprotocol(INVITED_PROTOCOL), Subprotocol(invited)],
        proxy=None,
        max_size=None,
        open_timeout=60,
        ping_interval=None,
    ) as connection:
        yield connection


def answer(view: Connection, kind: str) -> dict[str, Any]:
    """Wait for the next answer of a kind."""
    while True:
        message: dict[str, Any] = json.loads(view.recv(timeout=60))
        if message["kind"] == kind:
            return message


def watch(view: Connection, clip: Path) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Send a clip frame by frame, waiting for each; return what was seen and recognised."""
    messages = []
    for time, jpeg in frames_of(clip):
        view.send(message_of(time, jpeg))
        messages.append(json.loads(view.recv(timeout=60)))
        if messages[-1]["state"] == "done" and messages[-2]["state"] == "recording":
            messages.append(json.loads(view.recv(timeout=60)))
            break
    return (
        [each for each in messages if each["kind"] == "seen"],
        [each for each in messages if each["kind"] == "recognized"],
    )


def sample_language(client: httpx.Client) -> str:
    listed = client.get("/api/v1/languages").json()
    return str(next(each["id"] for each in listed if "Table 2" in each["name"]))


@pytest.mark.slow
def test_a_gesture_shown_to_the_camera_is_recognised_when_its_second_salute_is_held(
    server: Running, client: httpx.Client, sample_clips: Path
) -> None:
    with live(server) as view:
        view.send(json.dumps({"do": "listen", "language_id": sample_language(client)}))
        listening = answer(view, "listening")
        assert listening["gestures"] > 0, listening
        seen, recognized = watch(view, sample_clips / "line-test-2.mp4")
    assert {each["state"] for each in seen} == {"idle", "recording", "done"}
    body = next(each["pose"] for each in seen if each["pose"])
    assert len(body) == 33
    assert all(0 <= x <= 1 for x, _ in body[:1])
    assert len(next(each["hands"] for each in seen if each["hands"])[0]) == 21
    assert max(each["salute"] for each in seen) > 0.5
    assert [each["time"] for each in seen] == sorted(each["time"] for each in seen)
    (take,) = recognized
    assert take["closed"]
    assert (take["label"], take["problem"]) == ("line", None)
    assert 1.5 < take["start"] < 2.2 < 3.4 < take["end"] < 4.4


def test_an_invited_person_learns_when_a_take_ends_and_not_what_was_read(
    server: Running, client: httpx.Client, sample_clips: Path
) -> None:
    token = token_of(invite(client, sample_language(client)))
    with live(server, invited=token) as view:
        assert view.subprotocol == INVITED_PROTOCOL
        seen, (take,) = watch(view, sample_clips / "line-test-2.mp4")
        assert {each["state"] for each in seen} == {"idle", "recording", "done"}
        assert take["closed"]
        read = {each for each, value in take.items() if value}
        assert read == {"kind", "start", "end", "closed"}
        # One at a time is looked at, whoever opens another one.
        with live(server, invited=token) as other, pytest.raises(ConnectionClosed) as closed:
            other.recv(timeout=60)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == TRY_AGAIN_LATER
        view.send(json.dumps({"do": "listen", "language_id": sample_language(client)}))
        with pytest.raises(ConnectionClosed) as closed:
            view.recv(timeout=60)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == UNSUPPORTED_DATA
    for wrong in (token[1:], "x"):
        with pytest.raises(InvalidHandshake), live(server, invited=wrong):
            raise AssertionError("the view is open")


def test_the_camera_of_an_invited_person_ends_with_the_invitation_and_leaves_its_place(
    server: Running, client: httpx.Client
) -> None:
    language = sample_language(client)
    made, other = (invite(client, language) for _ in range(2))
    with live(server, invited=token_of(made)) as view:
        place = f"/api/v1/languages/{language}/invitations/{made['id']}"
        assert client.delete(place).status_code == 204
        with pytest.raises(ConnectionClosed) as closed:
            view.recv(timeout=60)
        assert closed.value.rcvd is not None
        assert (closed.value.rcvd.code, closed.value.rcvd.reason) == (
            POLICY_VIOLATION,
            "invitation_closed",
        )
    # Who leaves and comes back, or comes next, waits for the place and is not sent away.
    for _ in range(3):
        with live(server, invited=token_of(other)) as view:
            view.send(json.dumps({"do": "listen"}))
            with pytest.raises(ConnectionClosed) as closed:
                view.recv(timeout=60)
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == UNSUPPORTED_DATA


def test_only_the_newest_of_many_frames_is_looked_at(server: Running, sample_clips: Path) -> None:
    with live(server) as view:
        _, jpeg = next(frames_of(sample_clips / "line-test-2.mp4"))
        for index in range(40):
            view.send(message_of(index / 25, jpeg))
        looked = [answer(view, "seen")]
        while looked[-1]["time"] < 39 / 25:
            looked.append(answer(view, "seen"))
    assert len(looked) + sum(each["skipped"] for each in looked) == 40
    assert any(each["skipped"] for each in looked)
    assert all(each["frames_per_second"] >= 0 and each["seconds"] > 0 for each in looked)


def test_a_language_without_gestures_is_told_before_anything_is_shown(
    server: Running, language_id: str
) -> None:
    with live(server) as view:
        view.send(json.dumps({"do": "listen", "language_id": language_id}))
        assert "no gestures" in answer(view, "listening")["problem"]
        view.send(json.dumps({"do": "listen", "language_id": "nothing"}))
        assert "no language" in answer(view, "listening")["problem"]
        view.send(json.dumps({"do": "listen"}))
        assert answer(view, "listening")["problem"] is None


def test_a_view_too_many_is_told_so_and_one_that_leaves_makes_room(server: Running) -> None:
    with ExitStack() as others, live(server) as view:
        for other in [view, *(others.enter_context(live(server)) for _ in range(MOST_VIEWS - 1))]:
            other.send(json.dumps({"do": "listen"}))
            answer(other, "listening")
        closed = closing(server)
        assert closed == (TRY_AGAIN_LATER, f"{MOST_VIEWS} live views are open already; close one")
    until(lambda: closing(server, "{")[0] != TRY_AGAIN_LATER)


def closing(server: Running, *messages: str | bytes) -> tuple[int, str]:
    """Send messages, and return with what code and reason the server closes the view."""
    with live(server) as view:
        with suppress(ConnectionClosed):
            for message in messages:
                view.send(message)
            while True:
                view.recv(timeout=60)
        assert view.protocol.close_code is not None
        return view.protocol.close_code, view.protocol.close_reason or ""


@pytest.mark.parametrize(
    ("message", "code", "reason"),
    [
        (message_of(1.0, b"no picture"), UNSUPPORTED_DATA, "no JPEG"),
        (b"short", UNSUPPORTED_DATA, "5 bytes"),
        (message_of(float("nan"), b"x"), UNSUPPORTED_DATA, "time is nan"),
        (message_of(1.0, bytes(1024 * 1024)), MESSAGE_TOO_BIG, "send smaller ones"),
        ('{"do": "dance"}', UNSUPPORTED_DATA, "not understood"),
        ("{", UNSUPPORTED_DATA, "not understood"),
    ],
)
def test_what_is_no_frame_ends_the_view_with_a_reason(
    server: Running, message: str | bytes, code: int, reason: str
) -> None:
    closed = closing(server, message)
    assert closed[0] == code
    assert reason in closed[1]


def test_a_frame_is_refused_by_its_size_before_it_takes_memory() -> None:
    assert decode_frame(jpeg_of(np.zeros((1080, 1920, 3), np.uint8))).shape == (1080, 1920, 3)
    with pytest.raises(VideoError, match="JPEG of at most"):
        decode_frame(jpeg_of(np.zeros((1600, 2400, 3), np.uint8)))
