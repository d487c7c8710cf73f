"""Loopback server: a viser server that only this machine's relay can reach."""

from __future__ import annotations

import contextlib
import hmac
import inspect
import io
import secrets
from collections.abc import Callable, Iterator
from threading import Lock
from typing import Any, Final

import viser
import websockets.asyncio.server
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

_KEY: Final = f"Bearer {secrets.token_urlsafe(32)}"
"""What the relay proves itself with; a new one in every process."""

RELAY_HEADERS: Final = {"Authorization": _KEY}
"""Headers with which the relay connects to a server of this module."""

NOT_THE_RELAY: Final = "Only OSG Studio's own relay may connect; open the studio's page instead.\n"

_ONE_AT_A_TIME = Lock()
"""Stdout and websockets' `serve` are replaced for the whole process; two replacements that overlap
would never be undone."""


def start_server() -> viser.ViserServer:
    """Start a viser server on a free loopback port, which answers the relay alone.

    viser checks neither origin nor token, so that any page in the user's browser, and any program
    of another user of this machine, could bypass the relay's checks. Only requests with
    `RELAY_HEADERS` and without an origin, which browsers always send, are answered. Requests for a
    public tunnel, which any client may make, are ignored.
    """
    with quiet(), _swapped_serve(_serve_relay):
        server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    server.request_share_url = no_public_tunnel  # type: ignore[method-assign]
    return server


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Suppress the banner that viser prints even with ``verbose=False``."""
    with _ONE_AT_A_TIME, contextlib.redirect_stdout(io.StringIO()):
        yield


def no_public_tunnel(*_: object, **__: object) -> None:
    """Ignore viser's request for a public tunnel."""


_serve = websockets.asyncio.server.serve


def _serve_relay(*given: Any, process_request: Any = None, **options: Any) -> _serve:
    """Serve as viser asks for, but only to the relay."""

    async def check(connection: ServerConnection, request: Request) -> Response | None:
        shown = ",".join(request.headers.get_all("Authorization"))
        if not hmac.compare_digest(shown.encode(errors="surrogateescape"), _KEY.encode()):
            return connection.respond(403, NOT_THE_RELAY)
        answer: Response | None = None
        if process_request is not None:
            made = process_request(connection, request)
            answer = await made if inspect.isawaitable(made) else made
        return answer

    return _serve(*given, process_request=check, origins=[None], **options)


@contextlib.contextmanager
def _swapped_serve(serve: Callable[..., _serve]) -> Iterator[None]:
    """Replace websockets' `serve` while viser starts, because viser has no option for it."""
    original = websockets.asyncio.server.serve
    websockets.asyncio.server.serve = serve  # type: ignore[assignment, misc]
    try:
        yield
    finally:
        websockets.asyncio.server.serve = original  # type: ignore[misc]
