"""Publish/subscribe: fans an event out to every open event stream, of all servers."""

from __future__ import annotations

import asyncio
import json
import math
import time
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar
from uuid import uuid4

from app.store.server_messages import Messages

Item = TypeVar("Item")
Result = TypeVar("Result")

SECONDS_PER_STREAM = 0.001
"""Shortest time in seconds between two progress events of a job, for each open stream: writing one
takes 20 to 150 us of a core (`benchmarks/studies/server.md`), so that a running job takes at most a
sixth of a core. With fewer than a hundred streams each event is written, ten a second."""

MOST_UNREAD = 256
"""Events kept for a stream that is not read; older ones are dropped, because each event describes a
state and not a change."""


@dataclass(frozen=True)
class Event:
    """One event.

    Attributes
    ----------
    kind
        ``clips``, ``languages``, ``recognitions`` or ``jobs`` for a change; ``checks``, ``exports``
        or ``tables`` for progress.
    data
        Plain JSON types, at least ``id``. For running ``jobs`` also ``progress``, the fields of
        `Progress`.

    """

    kind: str
    data: dict[str, Any]
    _shared: dict[str, asyncio.Future[Any]] = field(
        default_factory=dict, init=False, compare=False, repr=False
    )

    async def share(self, name: str, compute: Callable[[], Coroutine[Any, Any, Result]]) -> Result:
        """Return a value that is computed once for all streams that get this event.

        Parameters
        ----------
        name
            Name of the value.
        compute
            Called by the first stream that asks.

        """
        if name not in self._shared:
            self._shared[name] = asyncio.ensure_future(compute())
        # A stream that ends meanwhile must not cancel the computation for the others.
        value: Result = await asyncio.shield(self._shared[name])
        return value


class Unread(Generic[Item]):
    """What one open stream has not read yet.

    Parameters
    ----------
    most
        Number of items kept.

    """

    def __init__(self, most: int) -> None:
        self._items: asyncio.Queue[Item | None] = asyncio.Queue(most)

    def put(self, item: Item | None) -> None:
        """Add an item, dropping the oldest of a full queue; None ends the stream."""
        if self._items.full():
            self._items.get_nowait()
        self._items.put_nowait(item)

    async def __aiter__(self) -> AsyncIterator[Item]:
        """Yield items as they come, until the end of the stream."""
        while (item := await self._items.get()) is not None:
            yield item


Join = Callable[[Callable[[str], None], Callable[[], None]], Messages | None]
"""Opens the messages of all servers, see `app.store.server_messages.open_messages`."""


class Broadcast:
    """Publishes events from any thread to the streams on the event loop that created it.

    Parameters
    ----------
    join
        Opens the messages to the other servers, which get the same events; None for a single
        server.
    heard
        Called on the loop with every event of another server, before the streams get it.

    """

    def __init__(
        self, join: Join | None = None, heard: Callable[[Event], None] | None = None
    ) -> None:
        self._loop = asyncio.get_running_loop()
        self._subscriptions: set[Unread[Event]] = set()
        self._closed = False
        self._heard = heard
        self._origin = uuid4().hex
        self._told: dict[str, float] = {}
        self._messages = None if join is None else join(self._hear, self._miss)

    def publish(self, kind: str, **data: Any) -> None:
        """Send an event of this kind; see `send`."""
        self.send(Event(kind, data))

    def send(self, event: Event) -> None:
        """Put an event into all streams, from any thread; do nothing once the loop is closed."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._deliver, event)
            if self._messages is not None:
                told = {"origin": self._origin, "kind": event.kind, "data": event.data}
                self._messages.send(json.dumps(told))

    @contextmanager
    def subscribe(self) -> Iterator[Unread[Event]]:
        """Open a stream of the events from now on; use it on the event loop."""
        subscription = Unread[Event](MOST_UNREAD)
        self._subscriptions.add(subscription)
        if self._closed:
            subscription.put(None)
        try:
            yield subscription
        finally:
            self._subscriptions.discard(subscription)

    def close(self) -> None:
        """End all streams."""
        self._closed = True
        self._end_streams()

    def leave(self) -> None:
        """Stop exchanging events with the other servers."""
        if self._messages is not None:
            self._messages.close()

    def _hear(self, text: str) -> None:
        told = json.loads(text)
        if told["origin"] != self._origin and not self._loop.is_closed():
            event = Event(told["kind"], told["data"])
            self._loop.call_soon_threadsafe(self._take, event)

    def _take(self, event: Event) -> None:
        if self._heard is not None:
            self._heard(event)
        self._deliver(event)

    def _miss(self) -> None:
        """End the streams, so that the pages reconnect and load the changes they missed."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._end_streams)

    def _end_streams(self) -> None:
        for subscription in self._subscriptions:
            subscription.put(None)

    def _deliver(self, event: Event) -> None:
        if self._comes_too_soon(event):
            return
        for subscription in self._subscriptions:
            subscription.put(event)

    def _comes_too_soon(self, event: Event) -> bool:
        """Return whether a progress event follows the previous one of its job too soon."""
        progress = event.data.get("progress")
        if progress is None:
            self._told.pop(event.data.get("id", ""), None)
            return False
        now, job = time.monotonic(), event.data["id"]
        if now - self._told.get(job, -math.inf) < SECONDS_PER_STREAM * len(self._subscriptions):
            return True
        self._told[job] = now
        return False
