"""Page server: HTTP for the robot's page, with bounds on what strangers can make it hold."""

from __future__ import annotations

import re
import socket
import threading
import time as clock
from collections.abc import Callable
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ipaddress import ip_address
from typing import Any, Final
from urllib.parse import urlsplit

MOST_CONNECTIONS: Final = 32
"""Open connections; of more, the oldest is closed. A page asks once a second and is answered within
milliseconds, so an old connection is one that sends nothing."""

MOST_SECONDS: Final = 20.0
"""Longest time of one connection, which carries one request: enough for a language of some hundred
kilobytes over a slow tether."""

HOST: Final = re.compile(r"[\w.:\[\]-]+", re.ASCII)
"""Characters of a host header: of addresses, names and ports, and of no user."""

LOCAL_ENDINGS: Final = (".local", ".localhost", ".lan", ".internal", ".home.arpa")
"""Endings of names that only a local network gives, and no stranger on the internet."""


class PageServer(ThreadingHTTPServer):
    """Server with a bounded number of connections, each for a bounded time.

    Parameters
    ----------
    address
        Host and port to listen on.
    handler
        Answers one request.

    """

    daemon_threads = True
    # With the usual five, a page that comes in a burst of others waits for seconds.
    request_queue_size = 4 * MOST_CONNECTIONS
    # Two programs on one port would share the requests between them.
    allow_reuse_port = False

    def __init__(
        self, address: tuple[str, int], handler: Callable[..., BaseHTTPRequestHandler]
    ) -> None:
        self._open: dict[socket.socket, float] = {}
        self._lock = threading.Lock()
        if ":" in address[0]:
            self.address_family = socket.AF_INET6
        super().__init__(address, handler)

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer a connection in a thread of its own; close the oldest if there are too many."""
        with self._lock:
            self._open[request] = clock.monotonic()
            if len(self._open) > MOST_CONNECTIONS:
                self._end(next(iter(self._open)))
        super().process_request(request, client_address)

    def shutdown_request(self, request: Any) -> None:
        """Close a connection."""
        with self._lock:
            self._open.pop(request, None)
        super().shutdown_request(request)

    def service_actions(self) -> None:
        """Close the connections that have lasted too long; called several times a second."""
        with self._lock:
            late = clock.monotonic() - MOST_SECONDS
            for request in [each for each, began in self._open.items() if began < late]:
                self._end(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Print nothing: a client that goes away is no fault of the robot."""

    def _end(self, request: socket.socket) -> None:
        """Let the thread of a connection end: it reads no more."""
        del self._open[request]
        with suppress(OSError):
            request.shutdown(socket.SHUT_RDWR)


def is_own_host(host: str | None) -> bool:
    """Return whether a request's host can be this machine, whatever a foreign page resolves to it.

    A page on the internet reaches a machine behind a firewall by a name of its own that it lets
    point there (DNS rebinding). It cannot do that with an IP address, with this machine's name, or
    with a name of the local network.

    Parameters
    ----------
    host
        The header ``Host``; None: without one, which no browser sends.

    """
    if host is None:
        return True
    if not HOST.fullmatch(host):
        return False
    try:
        name = (urlsplit(f"//{host}").hostname or "").rstrip(".")
    except ValueError:
        return False
    with suppress(ValueError):
        ip_address(name.partition("%")[0])
        return True
    own = socket.gethostname().lower()
    return (
        name in ("localhost", own)
        or name.endswith(LOCAL_ENDINGS)
        or (bool(name) and "." not in name)
    )


def is_own_origin(origin: str | None, host: str | None) -> bool:
    """Return whether a request that changes something comes from this server's own page.

    Parameters
    ----------
    origin, host
        The headers of these names; a browser sends both.

    """
    if origin is None or host is None:
        return False
    try:
        return urlsplit(origin).netloc.lower() == host.lower() != ""
    except ValueError:
        return False
