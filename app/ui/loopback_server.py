"""Loopback server: a viser server that only this machine's relay can reach."""

from __future__ import annotations

import contextlib
import functools
import io
from collections.abc import Iterator
from threading import Lock

import viser
import websockets.asyncio.server

_ONE_AT_A_TIME = Lock()
"""Stdout and websockets' `serve` are replaced for the whole process; two replacements that overlap
would never be undone."""


def start_server() -> viser.ViserServer:
    """Start a viser server on a free loopback port, closed to web pages.

    viser checks no origin, so that any page in the user's browser could open a websocket to it and
    bypass the relay's checks. Browsers always send an origin, the relay sends none: only
    connections without an origin are accepted. Requests for a public tunnel, which any client may
    make, are ignored.
    """
    closed = functools.partial(websockets.asyncio.server.serve, origins=[None])
    with quiet(), _swapped_serve(closed):
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


@contextlib.contextmanager
def _swapped_serve(serve: functools.partial[websockets.asyncio.server.serve]) -> Iterator[None]:
    """Replace websockets' `serve` while viser starts, because viser has no option for it."""
    original = websockets.asyncio.server.serve
    websockets.asyncio.server.serve = serve  # type: ignore[assignment, misc]
    try:
        yield
    finally:
        websockets.asyncio.server.serve = original  # type: ignore[misc]
