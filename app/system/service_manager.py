"""Service manager: tells systemd that a service is ready, works, or stops (sd_notify)."""

from __future__ import annotations

import os
import socket
import time as clock
from collections.abc import Mapping
from contextlib import suppress
from typing import Final

MICROSECONDS: Final = 1e6

SHARE: Final = 0.5
"""Share of the watchdog's time between two signs of life, as sd_watchdog_enabled(3) advises."""


class ServiceManager:
    """Connection to systemd; does nothing if systemd did not start this process.

    Parameters
    ----------
    environment
        Variables ``NOTIFY_SOCKET``, the socket of systemd, and with a watchdog ``WATCHDOG_USEC``
        and ``WATCHDOG_PID``.

    """

    def __init__(self, environment: Mapping[str, str] = os.environ) -> None:
        address = environment.get("NOTIFY_SOCKET", "")
        # A first "@" stands for the zero byte of an abstract address.
        self._address = "\0" + address[1:] if address.startswith("@") else address
        microseconds = environment.get("WATCHDOG_USEC", "")
        mine = environment.get("WATCHDOG_PID", "") in ("", str(os.getpid()))
        watched = mine and microseconds.isdecimal()
        self._pause = int(microseconds) / MICROSECONDS * SHARE if watched else None
        self._beaten = -float("inf")
        self._status = ""

    def tell_ready(self) -> None:
        """Report that the service works from now on."""
        self._send("READY=1")

    def tell_alive(self) -> None:
        """Report that the service works, at most as often as the watchdog needs it."""
        now = clock.monotonic()
        if self._pause is not None and now - self._beaten >= self._pause:
            self._beaten = now
            self._send("WATCHDOG=1")

    def tell_status(self, text: str) -> None:
        """Report in one line what the service does, for ``systemctl status``."""
        if text != self._status:
            self._status = text
            self._send(f"STATUS={' '.join(text.split())}")

    def tell_stopping(self) -> None:
        """Report that the service ends."""
        self._send("STOPPING=1")

    def _send(self, line: str) -> None:
        if not self._address:
            return
        # A manager that is gone must not stop the service.
        with suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as channel:
            channel.connect(self._address)
            channel.sendall(line.encode())
