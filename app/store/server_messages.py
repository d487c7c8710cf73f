"""Server messages: sends texts between servers by PostgreSQL's LISTEN and NOTIFY, not on SQLite."""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from app.store.database import Database

if TYPE_CHECKING:
    from psycopg import Connection

CHANNEL: Final = "osg_studio"
MOST_BYTES: Final = 7900
"""Largest message: PostgreSQL takes payloads below 8000 bytes."""

MOST_UNSENT: Final = 1000
"""Messages kept while the database cannot be reached; older ones are dropped."""

PAUSE_SECONDS: Final = 1.0
"""Wait in seconds before reconnecting, and longest time to close."""

logger = logging.getLogger(__name__)


class Messages:
    """Sends texts to the other servers and receives theirs, by a thread and connection for each.

    Parameters
    ----------
    database, hear, missed
        As in `open_messages`.

    """

    def __init__(
        self, database: Database, hear: Callable[[str], None], missed: Callable[[], None]
    ) -> None:
        self._database, self._hear, self._missed = database, hear, missed
        self._unsent: deque[str] = deque(maxlen=MOST_UNSENT)
        self._woken, self._closed = threading.Event(), threading.Event()
        listening, sending = threading.Event(), threading.Event()
        self._threads = [
            threading.Thread(target=self._keep, args=(work, ready), daemon=True)
            for work, ready in ((self._listen, listening), (self._deliver, sending))
        ]
        for thread in self._threads:
            thread.start()
        # From here on the changes of other servers are received.
        listening.wait(PAUSE_SECONDS)

    def send(self, text: str) -> None:
        """Send a text to all servers, this one among them; from any thread, without waiting."""
        if len(text.encode()) > MOST_BYTES:
            logger.error("a message of %d bytes to the other servers is too large", len(text))
            return
        self._unsent.append(text)
        self._woken.set()

    def close(self) -> None:
        """Stop sending and receiving."""
        self._closed.set()
        self._woken.set()
        for thread in self._threads:
            thread.join(2 * PAUSE_SECONDS)

    def _keep(
        self, work: Callable[[Connection, threading.Event], None], ready: threading.Event
    ) -> None:
        """Run `work` on a separate connection, and again after each loss of the connection."""
        import psycopg

        url = self._database.engine.url.set(drivername="postgresql")
        while not self._closed.is_set():
            try:
                address = url.render_as_string(hide_password=False)
                with psycopg.connect(address, autocommit=True) as connection:
                    work(connection, ready)
            except psycopg.Error as error:
                logger.warning("the messages between servers are interrupted: %s", error)
                self._closed.wait(PAUSE_SECONDS)

    def _listen(self, connection: Connection, listening: threading.Event) -> None:
        connection.execute(f"LISTEN {CHANNEL}")
        if listening.is_set():
            self._missed()
        listening.set()
        while not self._closed.is_set():
            for notice in connection.notifies(timeout=PAUSE_SECONDS):
                self._hear(notice.payload)

    def _deliver(self, connection: Connection, _ready: threading.Event) -> None:
        while not self._closed.is_set():
            self._woken.wait()
            self._woken.clear()
            while self._unsent:
                # Removed only after it was sent, so that it is repeated after a lost connection.
                connection.execute("SELECT pg_notify(%s, %s)", (CHANNEL, self._unsent[0]))
                self._unsent.popleft()


def open_messages(
    database: Database, hear: Callable[[str], None], missed: Callable[[], None]
) -> Messages | None:
    """Open the messages of the servers that share a database; None for a database of one server.

    Parameters
    ----------
    database
        The database.
    hear
        Called with every text, in a thread.
    missed
        Called when texts may have been missed, in a thread: the connection was lost for a while.

    """
    return Messages(database, hear, missed) if database.shared else None
