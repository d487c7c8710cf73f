"""Links: an address that cannot be used is one clear line, and a broken connection is mended."""

from __future__ import annotations

import socket
import threading

import pytest

pytest.importorskip("pymavlink", reason="needs the extra mavlink")

from app.recognition.errors import VehicleError
from app.robot.mavlink import links
from app.robot.mavlink.links import DatagramLink, StreamLink, open_link
from app.robot.mavlink.talk import build_heartbeat


@pytest.mark.parametrize(
    "address",
    [
        "/dev/ttyACM0",
        "udpout:14550",
        "udpout::14550",
        "tcp:host",
        "tcp:h:99999",
        "ftp:h:1",
        "http:",
    ],
)
def test_an_address_of_another_form_is_refused(address: str) -> None:
    with pytest.raises(VehicleError, match=r"is no address of a vehicle; give udpout:HOST:PORT"):
        open_link(address, 1, 1)


@pytest.mark.parametrize("form", ["tcp:127.0.0.1:{}", "http://127.0.0.1:{}"])
def test_an_address_where_nobody_answers_is_told_at_once(form: str) -> None:
    with socket.socket() as taken:  # bound, and not listening
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(VehicleError, match="cannot be reached"):
            open_link(form.format(taken.getsockname()[1]), 1, 1)


def test_who_listens_answers_where_the_vehicle_speaks_from() -> None:
    listening = DatagramLink("127.0.0.1", 0, 1, listens=True)
    port = listening._socket.getsockname()[1]
    vehicle = DatagramLink("127.0.0.1", port, 1, listens=False)
    try:
        listening.send(build_heartbeat(), None)  # nobody is known yet
        vehicle.send(build_heartbeat(), None)
        ((message, sender),) = listening.receive(5)
        assert message.get_type() == "HEARTBEAT"
        listening.send(build_heartbeat(), sender)
        ((message, _),) = vehicle.receive(5)
        assert message.get_type() == "HEARTBEAT"
    finally:
        listening.close()
        vehicle.close()


def test_a_stream_that_breaks_is_connected_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(links, "RECONNECT_SECONDS", 0.0)
    heard: list[bytes] = []
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            for _ in range(2):
                connection, _ = server.accept()
                with connection:
                    heard.append(connection.recv(1000))

        thread = threading.Thread(target=serve)
        thread.start()
        link = StreamLink("127.0.0.1", server.getsockname()[1], 1)
        link.send(build_heartbeat(), None)
        with pytest.raises(ConnectionError, match="closed the connection"):
            link.receive(10)
        assert link.receive(0) == []
        link.send(build_heartbeat(), None)
        thread.join(10)
        link.close()
    assert len(heard) == 2
    assert all(heard)
