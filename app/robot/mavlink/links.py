"""MAVLink links: sockets to a vehicle, over UDP or TCP.

pymavlink packs and parses the messages. Its own connections are not used because they print to
stdout, where the robot's events go.
"""

from __future__ import annotations

import select
import socket
import time as clock
from typing import Final, Protocol
from urllib.parse import urlsplit

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.recognition.errors import VehicleError
from app.robot.mavlink.actions import OUR_COMPONENT, Message

LARGEST_DATAGRAM: Final = 65536

CONNECT_SECONDS: Final = 3.0
"""Time to connect over TCP; a vehicle on the same boat answers within milliseconds."""

RECONNECT_SECONDS: Final = 1.0
"""Seconds between two attempts to reconnect."""

FORMS: Final = "udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT or http://HOST[:PORT][/PATH]"


class VehicleLink(Protocol):
    """Protocol of a connection to a vehicle, used by one thread."""

    def send(self, message: Message) -> None:
        """Send a message; raises `OSError` when that fails."""
        ...

    def receive(self, seconds: float) -> list[Message]:
        """Return the messages that arrived; wait at most `seconds` for the first."""
        ...

    def close(self) -> None:
        """End the connection."""
        ...


class DatagramLink:
    """UDP to a vehicle; a `VehicleLink`.

    Parameters
    ----------
    host, port
        Address to send to, or to listen on with `listens`.
    system
        Our MAVLink system id: that of the vehicle, of which this computer is a part.
    listens
        Whether the vehicle sends first; replies go to the address that its packets come from.

    """

    def __init__(self, host: str, port: int, system: int, *, listens: bool) -> None:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._target = None if listens else address
        self._listens = listens
        if listens:
            self._socket.bind(address)
        self._codec = mavlink.MAVLink(self, system, OUR_COMPONENT)
        self._codec.robust_parsing = True

    def write(self, data: bytes) -> None:
        """Send bytes; pymavlink calls this. Nothing is sent before the vehicle is known."""
        if self._target is not None:
            self._socket.sendto(data, self._target)

    def send(self, message: Message) -> None:
        """Send a message."""
        self._codec.send(message)

    def receive(self, seconds: float) -> list[Message]:
        """Return the messages that arrived."""
        found: list[Message] = []
        while select.select([self._socket], [], [], 0 if found else seconds)[0]:
            data, sender = self._socket.recvfrom(LARGEST_DATAGRAM)
            if self._listens:
                self._target = sender
            found += self._codec.parse_buffer(data) or []
        return found

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


class StreamLink:
    """TCP to a vehicle or its router, which reconnects after a failure; a `VehicleLink`.

    Parameters
    ----------
    host, port
        Address to connect to.
    system
        Our MAVLink system id.

    """

    def __init__(self, host: str, port: int, system: int) -> None:
        self._address = (host, port)
        self._system = system
        self._tried = 0.0
        self._socket: socket.socket | None = None
        self._connect()

    def write(self, data: bytes) -> None:
        """Send bytes; pymavlink calls this."""
        if self._socket is None:
            self._connect()
        assert self._socket is not None
        try:
            self._socket.sendall(data)
        except OSError:
            self._drop()
            raise

    def send(self, message: Message) -> None:
        """Send a message."""
        self._codec.send(message)

    def receive(self, seconds: float) -> list[Message]:
        """Return the messages that arrived."""
        if self._socket is None:
            clock.sleep(seconds)
            return []
        if not select.select([self._socket], [], [], seconds)[0]:
            return []
        try:
            data = self._socket.recv(LARGEST_DATAGRAM)
        except OSError:
            self._drop()
            raise
        if not data:
            self._drop()
            raise ConnectionError("the vehicle closed the connection")
        return self._codec.parse_buffer(data) or []

    def close(self) -> None:
        """Close the connection."""
        self._drop()

    def _connect(self) -> None:
        """Connect, at most once in `RECONNECT_SECONDS`."""
        if clock.monotonic() < self._tried + RECONNECT_SECONDS:
            raise ConnectionError("not connected")
        self._tried = clock.monotonic()
        self._socket = socket.create_connection(self._address, CONNECT_SECONDS)
        self._codec = mavlink.MAVLink(self, self._system, OUR_COMPONENT)
        self._codec.robust_parsing = True

    def _drop(self) -> None:
        if self._socket is not None:
            self._socket.close()
            self._socket = None


def open_link(address: str, system: int, component: int) -> VehicleLink:
    """Open the link of an address.

    Parameters
    ----------
    address
        One of `FORMS`; ``http`` is the address of mavlink2rest.
    system, component
        MAVLink ids of the vehicle.

    Raises
    ------
    VehicleError
        When the address has another form, or nothing answers there.

    """
    from app.robot.mavlink.rest_link import RestLink

    kind, _, rest = address.partition(":")
    try:
        if kind in ("http", "https"):
            return RestLink(address, system, component)
        place = urlsplit(f"//{rest}")
        host, port = place.hostname, place.port
        if kind not in ("udpout", "udpin", "tcp") or not host or not port or place.path:
            raise ValueError("no such form")
        if kind == "tcp":
            return StreamLink(host, port, system)
        return DatagramLink(host, port, system, listens=kind == "udpin")
    except VehicleError:
        raise
    except ValueError as error:
        raise VehicleError(f"{address!r} is no address of a vehicle; give {FORMS}") from error
    except OSError as error:
        raise VehicleError(
            f"{address} cannot be reached ({error.strerror or error}); check the address, and "
            "whether the vehicle is on"
        ) from error
