"""Who can talk to a workspace's viser server, and what they cannot ask of it."""

from collections.abc import Iterator
from threading import Event

import httpx
import msgspec
import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Origin, Subprotocol

from app.ui import loopback_server
from app.ui.loopback_server import RELAY_HEADERS

PROTOCOL = Subprotocol(f"viser-v{viser.__version__}")


@pytest.fixture
def server() -> Iterator[viser.ViserServer]:
    running = loopback_server.start_server()
    yield running
    running.stop()


@pytest.mark.parametrize("origin", ["http://evil.example", "http://127.0.0.1:8000", "null"])
def test_a_page_cannot_reach_it_past_the_relay(server: viser.ViserServer, origin: str) -> None:
    url = f"ws://127.0.0.1:{server.get_port()}"
    with (
        pytest.raises(InvalidStatus) as refused,
        connect(
            url,
            origin=Origin(origin),
            subprotocols=[PROTOCOL],
            additional_headers=RELAY_HEADERS,
            proxy=None,
        ),
    ):
        pass
    assert refused.value.response.status_code == 403


@pytest.mark.parametrize("headers", [[], ["Bearer x"], ["", ""], ["Bearer \u00e9"]], ids=str)
def test_a_program_of_another_user_of_this_machine_cannot_reach_it(
    server: viser.ViserServer, headers: list[str]
) -> None:
    url = f"ws://127.0.0.1:{server.get_port()}"
    shown = [("Authorization", each) for each in headers]
    with (
        pytest.raises(InvalidStatus) as refused,
        connect(url, subprotocols=[PROTOCOL], additional_headers=shown, proxy=None),
    ):
        pass
    assert refused.value.response.status_code == 403


def test_its_page_is_not_for_everybody_either(server: viser.ViserServer) -> None:
    assert httpx.get(f"http://127.0.0.1:{server.get_port()}/").status_code == 403


def test_the_relay_reaches_it(server: viser.ViserServer) -> None:
    url = f"ws://127.0.0.1:{server.get_port()}"
    with connect(
        url, subprotocols=[PROTOCOL], additional_headers=RELAY_HEADERS, proxy=None
    ) as relay:
        assert relay.subprotocol == PROTOCOL


def test_no_client_can_open_a_public_tunnel(monkeypatch: pytest.MonkeyPatch) -> None:
    refused = Event()
    tunnels: list[object] = []
    monkeypatch.setattr("viser._viser.ViserTunnel", lambda *_: tunnels.append(1))
    monkeypatch.setattr(loopback_server, "no_public_tunnel", lambda *_, **__: refused.set())
    server = loopback_server.start_server()
    request = msgspec.msgpack.encode({"type": "ShareUrlRequest"})
    try:
        url = f"ws://127.0.0.1:{server.get_port()}"
        with connect(
            url, subprotocols=[PROTOCOL], additional_headers=RELAY_HEADERS, proxy=None
        ) as client:
            client.send(request)
            assert refused.wait(60)
    finally:
        server.stop()
    assert tunnels == []


def test_nothing_is_printed_for_a_workspace(capsys: pytest.CaptureFixture[str]) -> None:
    server = loopback_server.start_server()
    with loopback_server.quiet():
        server.stop()
    assert capsys.readouterr().out == ""
