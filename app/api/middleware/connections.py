"""Connection guard: limits open connections, and closes those on which no request comes.

uvicorn ends idle connections only between two requests: a client that connects and sends nothing,
or sends a request's header byte by byte, would hold a file descriptor for ever.
"""

from __future__ import annotations

import asyncio
import sys
import time
from collections import Counter
from dataclasses import dataclass
from typing import Any

from uvicorn.protocols.http.auto import AutoHTTPProtocol

MOST_CONNECTIONS = 4096
"""Most open connections, if the system allows as many files: 500 open pages with eight each."""

FEWEST_CONNECTIONS = 32
"""Connections allowed even if the system allows very few files."""

SHARE_OF_FILES = 0.6
"""Share of the files that a process may open; the others are for clips, pipes and the database."""

SHARE_OF_ADDRESS = 0.5
"""Share of the connections that one address may have, so that it cannot take them all."""


@dataclass(eq=False)
class _Connection:
    """One open connection.

    `cycle` is its last request, `idle_since` the time at which that was found to be answered.
    """

    protocol: GuardedProtocol
    transport: asyncio.Transport
    address: str
    idle_since: float
    cycle: Any = None

    @property
    def idle(self) -> bool:
        """Whether no request is being answered; a websocket is never idle."""
        if self.transport.get_protocol() is not self.protocol:
            return False
        cycle = self.protocol.cycle
        return cycle is None or bool(cycle.response_complete)


class ConnectionGuard:
    """Counts and limits the connections of a server.

    Parameters
    ----------
    idle_seconds
        Seconds for a request's header, from the connection or the last answer on.
    most
        Most open connections at the same time; by default as many as the system allows.

    """

    def __init__(self, idle_seconds: float, most: int = 0) -> None:
        self._idle_seconds = idle_seconds
        self._most = most or raise_connection_limit()
        self._connections: dict[asyncio.BaseTransport, _Connection] = {}

    def __len__(self) -> int:
        """Return the number of open connections."""
        return len(self._connections)

    def open(self, protocol: GuardedProtocol) -> None:
        """Count a new connection; if there are too many, close the one idle longest."""
        address = protocol.client[0] if protocol.client else "local"
        connection = _Connection(protocol, protocol.transport, address, time.monotonic())
        self._connections[protocol.transport] = connection
        if len(self._connections) <= self._most * SHARE_OF_ADDRESS:
            return
        self._forget_closed()
        counts = Counter(each.address for each in self._connections.values())
        if counts[address] > max(self._most * SHARE_OF_ADDRESS, FEWEST_CONNECTIONS / 2):
            self._make_room(connection, address)
        elif len(self._connections) > self._most:
            # The address with the most connections loses one.
            self._make_room(connection, counts.most_common(1)[0][0])

    def close(self, transport: asyncio.BaseTransport) -> None:
        """Remove a closed connection."""
        self._connections.pop(transport, None)

    def sweep(self) -> None:
        """Close the connections on which no request came in time."""
        now = time.monotonic()
        self._forget_closed()
        for connection in list(self._connections.values()):
            cycle = connection.protocol.cycle
            if not connection.idle or cycle is not connection.cycle:
                connection.cycle, connection.idle_since = cycle, now
            elif now - connection.idle_since > self._idle_seconds:
                connection.transport.abort()

    def _make_room(self, new: _Connection, address: str) -> None:
        idle = [
            each
            for each in self._connections.values()
            if each is not new and each.address == address and each.idle
        ]
        victim = min(idle, key=lambda each: each.idle_since, default=new)
        victim.transport.abort()
        self.close(victim.transport)

    def _forget_closed(self) -> None:
        # A websocket's end is not reported to the protocol of the request that it began as.
        for transport in [each for each in self._connections if each.is_closing()]:
            self.close(transport)


class GuardedProtocol(AutoHTTPProtocol):  # type: ignore[misc, valid-type]  # chosen by uvicorn
    """uvicorn's HTTP protocol whose connections the guard of its app knows."""

    def connection_made(self, transport: asyncio.Transport) -> None:
        """Count the connection."""
        super().connection_made(transport)
        self._guard.open(self)

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._guard.close(self.transport)
        super().connection_lost(exc)

    @property
    def _guard(self) -> ConnectionGuard:
        guard: ConnectionGuard = self.config.app.state.connections
        return guard


def raise_connection_limit() -> int:
    """Raise the process's limit of open files, and return how many connections it may have."""
    if sys.platform == "win32":
        return MOST_CONNECTIONS // 8  # its limit of sockets in one loop
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = int(MOST_CONNECTIONS / SHARE_OF_FILES)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        raised = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        if raised > soft:
            resource.setrlimit(resource.RLIMIT_NOFILE, (raised, hard))
            soft = raised
        return max(FEWEST_CONNECTIONS, int(soft * SHARE_OF_FILES))
    return MOST_CONNECTIONS
