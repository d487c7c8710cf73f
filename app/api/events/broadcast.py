"""News for everybody who listens: one publisher's word reaches all open event streams."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

MOST_UNREAD = 256
"""News kept for a listener that does not read; older ones are dropped, since each says how things
stand and not what changed."""


@dataclass(frozen=True)
class News:
    """One message.

    Attributes
    ----------
    kind
        ``clips``, ``languages``, ``recognitions`` or ``jobs``: what changed; ``checks``: how far
        one is.
    data
        JSON types; at least ``id``.

    """

    kind: str
    data: dict[str, Any]


class Listener:
    """One open stream's unread news."""

    def __init__(self) -> None:
        self._unread: asyncio.Queue[News | None] = asyncio.Queue(MOST_UNREAD)

    def put(self, news: News | None) -> None:
        """Add one, dropping the oldest when nobody reads; ``None`` ends the stream."""
        if self._unread.full():
            self._unread.get_nowait()
        self._unread.put_nowait(news)

    async def __aiter__(self) -> AsyncIterator[News]:
        """Yield news as they come, until the server stops."""
        while (news := await self._unread.get()) is not None:
            yield news


class Broadcast:
    """Hands news from any thread to the listeners on the event loop it was made on."""

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._listeners: set[Listener] = set()
        self._closed = False

    def publish(self, kind: str, **data: Any) -> None:
        """Tell all listeners; callable from any thread, does nothing once the loop is closed."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._deliver, News(kind, data))

    @contextmanager
    def listening(self) -> Iterator[Listener]:
        """Open a stream of what is published from now on; use it on the event loop."""
        listener = Listener()
        self._listeners.add(listener)
        if self._closed:
            listener.put(None)
        try:
            yield listener
        finally:
            self._listeners.discard(listener)

    def close(self) -> None:
        """End all streams."""
        self._closed = True
        for listener in self._listeners:
            listener.put(None)

    def _deliver(self, news: News) -> None:
        for listener in self._listeners:
            listener.put(news)
