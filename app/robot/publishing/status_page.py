"""Status page: shows the robot's events, and whether it works, in a browser."""

from __future__ import annotations

import json
import threading
import time as clock
from collections import deque
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib import resources
from typing import Any, Final

from app import __version__
from app.recognition.errors import PublishError
from app.robot.event_messages import to_message
from app.robot.events import (
    Event,
    Heartbeat,
    LanguageChanged,
    SourceLost,
    SourceOpened,
    SourceRestored,
)

MOST_EVENTS: Final = 50
"""Events that the page shows; older ones are in the log."""

SILENT_SECONDS: Final = 30.0
"""Seconds without an event of a live source after which the robot counts as hung: six
heartbeats."""

POLL_SECONDS: Final = 0.1
"""Longest time in seconds until the server notices that it is closed."""

SERVICE: Final = {
    "name": "Diver gestures",
    "description": "Recognises gestures of divers and commands the vehicle",
    "icon": "mdi-diving-scuba",
    "company": "OSG Studio",
    "version": __version__,
    "webpage": "",
    "api": "",
    "new_page": False,
    "works_in_relative_paths": True,
}
"""Data that BlueOS requires to show a service in its menu (``/register_service``)."""


class StatusPage:
    """Web server with one page; a `Publisher`.

    The server is read-only. ``/`` is the page and ``/status.json`` its data, ``/healthz`` answers
    200 or 503, and ``/register_service`` registers the page in BlueOS.

    Parameters
    ----------
    host, port
        Address to listen on; port 0 finds a free one.
    describe
        Describes an event in one sentence; empty for events that need none.

    Raises
    ------
    PublishError
        When it cannot listen there.

    """

    def __init__(self, host: str, port: int, describe: Callable[[Event], str]) -> None:
        self._describe = describe
        self._lock = threading.Lock()
        self._events: deque[dict[str, Any]] = deque(maxlen=MOST_EVENTS)
        self._facts: dict[str, Any] = {"source": None, "language": None, "lost": False}
        self._live = False
        self._heard = clock.monotonic()
        page = (resources.files("app.robot.publishing") / "status_page.html").read_bytes()
        try:
            self._server = ThreadingHTTPServer((host, port), _build_handler(self, page))
        except (OSError, OverflowError) as error:
            raise PublishError(
                f"the page cannot be served at {host}:{port} ({error}); another program may have "
                "the port, choose another"
            ) from error
        self._server.daemon_threads = True
        self._thread = threading.Thread(
            target=self._server.serve_forever, args=(POLL_SECONDS,), name="page", daemon=True
        )
        self._thread.start()

    @property
    def port(self) -> int:
        """Port that the server listens on."""
        return int(self._server.server_address[1])

    def publish(self, event: Event) -> None:
        """Add one event to the page."""
        with self._lock:
            self._heard = clock.monotonic()
            match event:
                case SourceOpened(source=source, live=live):
                    self._live = live
                    self._facts["source"] = source
                case LanguageChanged(name=name, code=code, revision=revision):
                    self._facts["language"] = {"name": name, "code": code, "revision": revision}
                case SourceLost():
                    self._facts["lost"] = True
                case SourceRestored():
                    self._facts["lost"] = False
                case Heartbeat(frames=frames, dropped=dropped):
                    self._facts |= {"frames": frames, "dropped": dropped}
            if text := self._describe(event):
                message = to_message(event).model_dump(mode="json")
                kind, time = message["event"], message["time"]
                self._events.append({"event": kind, "time": time, "text": text})

    def close(self) -> None:
        """Stop serving."""
        self._server.shutdown()
        self._thread.join()
        self._server.server_close()

    def read_status(self) -> dict[str, Any]:
        """Return the data of the page as plain JSON types."""
        with self._lock:
            seconds = clock.monotonic() - self._heard
            works = not self._live or seconds < SILENT_SECONDS
            return {
                "version": __version__,
                "works": works,
                "silent_seconds": round(seconds, 1),
                **self._facts,
                "events": list(self._events),
            }


def _build_handler(page: StatusPage, html: bytes) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            match self.path.partition("?")[0]:
                case "/":
                    self._answer(200, html, "text/html; charset=utf-8")
                case "/status.json":
                    self._answer_json(200, page.read_status())
                case "/healthz":
                    works = page.read_status()["works"]
                    self._answer_json(200 if works else 503, {"works": works})
                case "/register_service":
                    self._answer_json(200, SERVICE)
                case _:
                    self._answer_json(404, {"detail": "there is no such page"})

        def _answer_json(self, status: int, content: dict[str, Any]) -> None:
            body = json.dumps(content, allow_nan=False).encode()
            self._answer(status, body, "application/json")

        def _answer(self, status: int, body: bytes, kind: str) -> None:
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Cache-Control", "no-store")
            self.send_header("X-Content-Type-Options", "nosniff")
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:
            """Print nothing: stderr is for the robot's own words."""

    return Handler
