"""MAVLink links: sockets to a vehicle, over UDP or TCP.

pymavlink packs and parses the messages. Its own connections are not used because they print to
stdout, where the robot's events go.
"""

from __future__ import annotations

import math
import select
import socket
import time as clock
from pathlib import Path
from typing import Final
from urllib.parse import urlsplit

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.recognition.errors import VehicleError
from app.recognition.text.atomic_files import write_atomically
from app.robot.mavlink.actions import OUR_COMPONENT, Message
from app.robot.mavlink.peer import Sender
from app.robot.mavlink.rest_link import RestLink

LARGEST_DATAGRAM: Final = 4096
"""Bytes of a datagram that are read; a vehicle's or router's are at most 1500."""

MOST_DATAGRAMS: Final = 64
"""Datagrams read at once, so that a flood leaves time to send."""

MOST_FAULTS: Final = 8
"""Faulty messages in a datagram after which the rest of it is dropped."""

CONNECT_SECONDS: Final = 3.0
"""Seconds to connect over TCP; a vehicle on the same boat answers within milliseconds."""

UNCONFIRMED_MS: Final = 5000
"""Milliseconds after which a TCP connection whose other end confirms nothing is given up. The
system would wait for minutes, also for a vehicle that has long started again."""

RECONNECT_SECONDS: Final = 1.0
"""Seconds between two attempts to reconnect."""

SIGNING_BEGAN: Final = 1_420_070_400
"""Seconds from 1970 to 2015, at which the time of MAVLink's signatures begins."""

SIGNING_TICKS: Final = 100_000
"""Units of that time in a second."""

AHEAD_SECONDS: Final = 120
"""Seconds by which the kept signature time is ahead: twice the period of its renewal."""

RENEW_SECONDS: Final = 60
"""Seconds by which the kept time stays ahead at least: it is written once in a minute."""

LATEST_TIME: Final = 2**47
"""Signature time in the year 2059, half the range of its 48 bits: a later one was not written by
the bridge."""

FORMS: Final = "udpout:HOST:PORT, udpin:HOST:PORT, tcp:HOST:PORT or http://HOST[:PORT][/PATH]"


Packet = tuple[Message, Sender]
"""A message and where it came from."""


class Reader:
    """Parser of received bytes, which verifies signatures.

    Parameters
    ----------
    signing
        pymavlink's state of the signatures, shared by all readers of a link; without a key nothing
        is verified.
    most_faults
        Faulty messages after which the rest is left.

    """

    def __init__(self, signing: mavlink.MAVLinkSigning, most_faults: float = math.inf) -> None:
        self._codec = mavlink.MAVLink(None)
        self._codec.robust_parsing = True
        self._codec.signing = self._signing = signing
        self._most_faults = most_faults

    def read(self, data: bytes) -> tuple[list[Message], int]:
        """Parse bytes; return the messages, and the number of those that were dropped."""
        found: list[Message] = []
        faults = 0
        while faults < self._most_faults:
            known, bad = dict(self._signing.stream_timestamps), self._signing.badsig_count
            # A restart goes ahead of its vehicle, whose first message is not too old for that.
            ahead = self._signing.timestamp
            self._signing.timestamp -= AHEAD_SECONDS * SIGNING_TICKS
            message = self._codec.parse_char(data)
            self._signing.timestamp = max(ahead, self._signing.timestamp)
            data = b""
            if self._signing.badsig_count != bad:
                # pymavlink notes the time of a message before it verifies the signature: a forged
                # one would make it reject the vehicle's.
                self._signing.stream_timestamps = known
            if message is None:
                break
            if isinstance(message, mavlink.MAVLink_bad_data):
                faults += 1
            elif not isinstance(message, mavlink.MAVLink_unknown):
                found.append(message)
        return found, faults


class SigningTime:
    """Time of the signatures, which never goes back, whatever the machine's clock does.

    A vehicle rejects what is older than the last message it heard. A file holds a time ahead of all
    that was sent, where the next start begins unless the clock is later.

    Parameters
    ----------
    key
        Key of the signatures; None for none.
    file
        File of the time, beside the key; None: there is none.

    Raises
    ------
    VehicleError
        When the file holds no time, or cannot be written: the next start would not be heard.

    """

    def __init__(self, key: bytes | None, file: Path | None) -> None:
        self.signing = mavlink.MAVLinkSigning()
        if key is not None:
            self.signing.secret_key = key
            self.signing.sign_outgoing = True
            since = clock.time() - SIGNING_BEGAN
            self.signing.timestamp = max(0, round(since * SIGNING_TICKS))
        self._file, self._began = file, clock.monotonic()
        try:
            kept = int(file.read_bytes()) if file is not None and file.exists() else 0
            if not 0 <= kept < LATEST_TIME:
                raise ValueError("out of range")
        except (OSError, ValueError) as error:
            raise VehicleError(
                f"{file} holds no signature time ({error}); set the clock and delete the file"
            ) from error
        self._base = self.signing.timestamp = max(self.signing.timestamp, kept)
        self._keep(self._base)

    def go_on(self) -> None:
        """Let the time go on with a steady clock; called before each message that is sent."""
        passed = round((clock.monotonic() - self._began) * SIGNING_TICKS)
        time = self.signing.timestamp = max(self.signing.timestamp, self._base + passed)
        if time + RENEW_SECONDS * SIGNING_TICKS > self._kept:
            self._keep(time + AHEAD_SECONDS * SIGNING_TICKS)

    def _keep(self, time: int) -> None:
        self._kept = time
        try:
            if self._file is not None:
                write_atomically(self._file, str(time).encode())
        except OSError as error:
            raise VehicleError(
                f"{self._file} cannot be written ({error.strerror}): make its folder writable"
            ) from error


class DatagramLink:
    """UDP to a vehicle; a `VehicleLink`.

    Each datagram is parsed by itself, so that a stranger's bytes never join the vehicle's.

    Parameters
    ----------
    host, port
        Address to send to, or to listen on with `listens`.
    system
        Our MAVLink system id: that of the vehicle, of which this computer is a part.
    listens
        Whether the vehicle sends first; its address is then not known before.
    time
        Time and key of the signatures; None for none.

    """

    def __init__(
        self, host: str, port: int, system: int, *, listens: bool, time: SigningTime | None = None
    ) -> None:
        self._time = time or SigningTime(None, None)
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self.expected: Sender | None = None if listens else address
        self.dropped = 0
        if listens:
            self._socket.bind(address)
        self._to: Sender | None = None
        self._codec = mavlink.MAVLink(self, system, OUR_COMPONENT)
        self._codec.signing = self._time.signing

    def write(self, data: bytes) -> None:
        """Send bytes; pymavlink calls this."""
        self._socket.sendto(data, self._to or ())

    def send(self, message: Message, to: Sender | None) -> None:
        """Send a message; nothing before the vehicle is known."""
        self._to = to if self.expected is None else self.expected
        if self._to is not None:
            self._time.go_on()
            self._codec.send(message)

    def receive(self, seconds: float) -> list[Packet]:
        """Return the messages that arrived."""
        found: list[Packet] = []
        for number in range(MOST_DATAGRAMS):
            if not select.select([self._socket], [], [], 0 if number else seconds)[0]:
                break
            data, sender = self._socket.recvfrom(LARGEST_DATAGRAM)
            messages, dropped = Reader(self._codec.signing, MOST_FAULTS).read(data)
            self.dropped += dropped
            found += [(message, sender) for message in messages]
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
    time
        Time and key of the signatures; None for none.

    """

    def __init__(self, host: str, port: int, system: int, time: SigningTime | None = None) -> None:
        self.expected: Sender = (0,)
        self._address = (host, port)
        self._system = system
        self._time = time or SigningTime(None, None)
        self.dropped = 0
        self._tried = 0.0
        self._socket: socket.socket | None = None
        self._connect()

    def write(self, data: bytes) -> None:
        """Send bytes; pymavlink calls this."""
        assert self._socket is not None
        try:
            self._socket.sendall(data)
        except OSError:
            self.close()
            raise

    def send(self, message: Message, to: Sender | None) -> None:
        """Send a message; nothing that was meant for the connection before."""
        if self._socket is None:
            self._connect()
        if to in (None, self.expected):
            self._time.go_on()
            self._codec.send(message)

    def receive(self, seconds: float) -> list[Packet]:
        """Return the messages that arrived."""
        if self._socket is None:
            clock.sleep(seconds)
            return []
        if not select.select([self._socket], [], [], seconds)[0]:
            return []
        try:
            data = self._socket.recv(LARGEST_DATAGRAM)
        except OSError:
            self.close()
            raise
        if not data:
            self.close()
            raise ConnectionError("the vehicle closed the connection")
        messages, dropped = self._reader.read(data)
        self.dropped += dropped
        return [(message, self.expected) for message in messages]

    def _connect(self) -> None:
        """Connect, at most once in `RECONNECT_SECONDS`."""
        if clock.monotonic() < self._tried + RECONNECT_SECONDS:
            raise ConnectionError("not connected")
        self._tried = clock.monotonic()
        self._socket = socket.create_connection(self._address, CONNECT_SECONDS)
        if hasattr(socket, "TCP_USER_TIMEOUT"):  # on Linux
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNCONFIRMED_MS)
        self.expected = (self.expected[0] + 1,)
        self._codec = mavlink.MAVLink(self, self._system, OUR_COMPONENT)
        self._codec.signing = self._time.signing
        self._reader = Reader(self._time.signing)

    def close(self) -> None:
        """Close the connection."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None


VehicleLink = DatagramLink | StreamLink | RestLink
"""A connection to a vehicle, used by one thread. `expected` is the only address that may be the
vehicle's; None for any. It changes with a new connection, whose other end may be another vehicle.
`dropped` counts messages that were damaged, or not signed as they should be."""


def open_link(
    address: str,
    system: int,
    component: int,
    key: bytes | None = None,
    time_file: Path | None = None,
) -> VehicleLink:
    """Open the link of an address.

    Parameters
    ----------
    address
        One of `FORMS`; ``http`` is the address of mavlink2rest.
    system, component
        MAVLink ids of the vehicle.
    key
        Key of 32 bytes that signs all messages; None: they are not signed.
    time_file
        File that keeps the time of the signatures; None: a restart relies on the clock.

    Raises
    ------
    VehicleError
        When the address has another form, nothing answers there, messages cannot be signed there,
        or the time of the signatures cannot be kept.

    """
    kind, _, rest = address.partition(":")
    try:
        if kind in ("http", "https"):
            if key is not None:
                raise VehicleError(
                    "mavlink2rest signs no messages: connect by udpout, udpin or tcp, or take "
                    "vehicle.key_file out of the table"
                )
            return RestLink(address, system, component)
        place = urlsplit(f"//{rest}")
        host, port = place.hostname, place.port
        if kind not in ("udpout", "udpin", "tcp") or not host or not port or place.path:
            raise ValueError("no such form")
        time = SigningTime(key, time_file)
        if kind == "tcp":
            return StreamLink(host, port, system, time)
        return DatagramLink(host, port, system, listens=kind == "udpin", time=time)
    except VehicleError:
        raise
    except ValueError as error:
        raise VehicleError(f"{address!r} is no address of a vehicle; give {FORMS}") from error
    except OSError as error:
        raise VehicleError(
            f"{address} cannot be reached ({error.strerror or error}); check the address, and "
            "whether the vehicle is on"
        ) from error
