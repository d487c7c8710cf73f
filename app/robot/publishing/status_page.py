"""Status page: shows the robot's events in a browser; its server bounds connections and time."""

from __future__ import annotations

import json
import re
import socket
import threading
import time as clock
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib import resources
from ipaddress import ip_address
from typing import TYPE_CHECKING, Any, Final, cast
from urllib.parse import urlsplit

from app import __version__
from app.recognition.errors import OsgError, PublishError
from app.robot import events
from app.robot.event_messages import to_message

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


if TYPE_CHECKING:  # it reads vehicle tables, which need a package of the extra mavlink
    from app.robot.publishing.robot_files import FileKind, RobotFiles

MOST_EVENTS: Final = 50
"""Events that the page shows; older ones are in the log."""

SILENT_SECONDS: Final = 30.0
"""Seconds without an event of a live source after which the robot counts as hung: six
heartbeats."""

POLL_SECONDS: Final = 0.1
"""Longest time in seconds until the server notices that it is closed."""

POLICY: Final = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'"
)
"""Content security policy: the page loads nothing from elsewhere, and sends nothing there."""

UPLOAD_TYPE: Final = "application/octet-stream"
"""Content type of an upload, which a form of another page cannot send."""

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

    ``/`` is the page and ``/status.json`` its data, ``/healthz`` answers 200 or 503, and
    ``/register_service`` registers the page in BlueOS. With `files`, the page takes uploads at
    ``/files/language`` and ``/files/vehicle``, and the latter tells what the table would send;
    without, it changes nothing. A host name that a foreign page could have let point here is
    refused.

    Parameters
    ----------
    host, port
        Address to listen on; port 0 finds a free one.
    describe
        Describes an event in one sentence; empty for events that need none.
    files
        Files that the page takes by upload; None: it takes none.

    Raises
    ------
    PublishError
        When it cannot listen there.

    """

    def __init__(
        self,
        host: str,
        port: int,
        describe: Callable[[events.Event], str],
        files: RobotFiles | None = None,
    ) -> None:
        self._describe = describe
        self.files = files
        self._waits_for = ""
        self._lock = threading.Lock()
        self._events: deque[dict[str, Any]] = deque(maxlen=MOST_EVENTS)
        self._facts: dict[str, Any] = {
            "source": None,
            "language": None,
            "lost": False,
            "slow": "",
        }
        self._live = False
        self._heard = clock.monotonic()
        html = (resources.files("app.robot.publishing") / "status_page.html").read_bytes()
        try:
            shown = {"page": self, "html": html, "uploading": threading.Lock()}
            self._server = PageServer((host, port), type("Handler", (PageHandler,), shown))
        except (OSError, OverflowError) as error:
            raise PublishError(
                f"the page cannot be served at {host}:{port} ({error}); another program may have "
                "the port, choose another"
            ) from error
        self._thread = threading.Thread(
            target=self._server.serve_forever, args=(POLL_SECONDS,), name="page", daemon=True
        )
        self._thread.start()

    @property
    def port(self) -> int:
        """Port that the server listens on."""
        return int(self._server.server_address[1])

    def publish(self, event: events.Event) -> None:
        """Add one event to the page."""
        with self._lock:
            self._heard = clock.monotonic()
            match event:
                case events.SourceOpened(source=source, live=live):
                    self._live = live
                    self._facts["source"] = source
                case events.LanguageChanged(name=name, code=code, revision=revision):
                    self._facts["language"] = {"name": name, "code": code, "revision": revision}
                case events.SourceLost():
                    self._facts["lost"] = True
                case events.SourceRestored():
                    self._facts["lost"] = False
                case events.FrameRateChanged(sufficient=sufficient):
                    self._facts["slow"] = "" if sufficient else event.words
                case events.Heartbeat(frames=frames, dropped=dropped):
                    self._facts |= {"frames": frames, "dropped": dropped}
            if text := self._describe(event):
                message = to_message(event).model_dump(mode="json")
                kind, time = message["event"], message["time"]
                self._events.append({"event": kind, "time": time, "text": text})

    def wait_for(self, reason: str) -> None:
        """Show why the robot does not run yet; empty: it runs."""
        with self._lock:
            self._waits_for = reason
            self._live &= not reason

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
                "waits_for": self._waits_for,
                "files": None if self.files is None else {"missing": self.files.list_missing()},
                **self._facts,
                "events": list(self._events),
            }


class PageHandler(BaseHTTPRequestHandler):
    """Answers one request to a `StatusPage`.

    Attributes
    ----------
    page
        The page, which `StatusPage` sets in a class of its own.
    html
        Its document.
    uploading
        Held while an upload is read, so that there is one in memory at most.

    """

    page: StatusPage
    html: bytes
    uploading: threading.Lock

    server_version = "osg-studio"
    sys_version = ""

    def do_GET(self) -> None:
        """Answer a request that changes nothing."""
        if not self._is_for_us():
            return
        match self.path.partition("?")[0]:
            case "/":
                self._answer(200, self.html, "text/html; charset=utf-8")
            case "/status.json":
                self._answer_json(200, self.page.read_status())
            case "/healthz":
                works = self.page.read_status()["works"]
                self._answer_json(200 if works else 503, {"works": works})
            case "/files/vehicle" if self.page.files is not None:
                self._answer_json(200, {"actions": self.page.files.list_actions()})
            case "/register_service":
                self._answer_json(200, SERVICE)
            case _:
                self._refuse(404, "there is no such page")

    def do_POST(self) -> None:
        """Take an upload; see `RobotFiles`."""
        if not self._is_for_us():
            return
        files, kind = self.page.files, self.path.rpartition("/files/")[2]
        if files is None or files.find_path(kind) is None:
            self._refuse(404, "there is no such page")
        elif refused := self._find_upload_fault(files.most_bytes):
            self._refuse(*refused)
        elif not self.uploading.acquire(blocking=False):
            self._refuse(503, "another file is being uploaded; try again in a moment")
        else:
            try:
                answer = self._take(files, cast("FileKind", kind))
            finally:
                self.uploading.release()  # before the answer, after which the next upload may come
            self._answer_json(*answer)

    def _find_upload_fault(self, most_bytes: int) -> tuple[int, str] | None:
        """Return status and detail of a request that is no upload of this page's own."""
        if not is_own_origin(self.headers["Origin"], self.headers["Host"]):
            return 403, "only this robot's own page may do this: open it by its address"
        if self.headers["Content-Type"] != UPLOAD_TYPE:
            return 415, f"send the file as {UPLOAD_TYPE}"
        size = self.headers["Content-Length"] or ""
        if not (size.isascii() and size.isdecimal()):
            return 411, "the size of the file is missing"
        if len(size) > len(str(most_bytes)) or int(size) > most_bytes:
            return 413, f"a file has at most {most_bytes / 1e6:g} million bytes"
        return None

    def _take(self, files: RobotFiles, kind: FileKind) -> tuple[int, dict[str, Any]]:
        """Read an upload; return status and content of the answer."""
        size = int(self.headers["Content-Length"])
        content = self.rfile.read(size)
        if len(content) < size:
            return 400, {"detail": "the file broke off; send it again"}
        token = self.headers["Confirm"]
        try:
            if token is None:
                status, proposal = 200, files.propose(kind, content)
            elif (changed := files.replace(kind, content, token)) is None:
                return 200, {"replaced": True}
            else:
                status, proposal = 409, changed
        except OsgError as error:
            return 422, {"detail": str(error)}
        except OSError as error:
            return 507, {"detail": f"the file cannot be written: {error.strerror or error}"}
        return status, {"changes": proposal.changes, "token": proposal.token}

    def _is_for_us(self) -> bool:
        """Refuse a request for another host; see `is_own_host`."""
        if is_own_host(self.headers["Host"]):
            return True
        self._refuse(403, "the robot does not know this host: open its page by its address")
        return False

    def _refuse(self, status: int, detail: str) -> None:
        self._answer_json(status, {"detail": detail})

    def _answer_json(self, status: int, content: dict[str, Any]) -> None:
        body = json.dumps(content, allow_nan=False).encode()
        self._answer(status, body, "application/json")

    def _answer(self, status: int, body: bytes, kind: str) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Content-Security-Policy", POLICY)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing: stderr is for the robot's own words."""


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
