"""The socket of a service manager: notes what services tell it."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class ServiceSocket:
    """A real datagram socket, as systemd has one for each service."""

    def __init__(self, address: str) -> None:
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(address)

    def wait(self, seconds: float = 60.0) -> str:
        """Return the next line."""
        self._socket.settimeout(seconds)
        return self._socket.recv(4096).decode()

    def wait_for(self, line: str) -> None:
        """Read lines until this one."""
        while self.wait() != line:
            pass

    def read(self) -> list[str]:
        """Return the lines that have arrived."""
        lines = []
        self._socket.setblocking(False)
        try:
            while True:
                lines.append(self._socket.recv(4096).decode())
        except BlockingIOError:
            return lines

    def close(self) -> None:
        """Close it, as when the manager is gone."""
        self._socket.close()


@contextmanager
def managing(folder: Path) -> Iterator[tuple[ServiceSocket, dict[str, str]]]:
    """Give a socket, and the variables that a service finds it by."""
    address = str(folder / "notify")
    channel = ServiceSocket(address)
    try:
        yield channel, {"NOTIFY_SOCKET": address, "WATCHDOG_USEC": "30000000"}
    finally:
        channel.close()
