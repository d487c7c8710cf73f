"""A viser server that only this machine's own relay can talk to."""

from __future__ import annotations

import contextlib
import functools
import io
from collections.abc import Iterator
from threading import Lock

import viser
import websockets.asyncio.server

_ONE_AT_A_TIME = Lock()
"""Both what is printed and what websockets serves with are swapped for the whole process; two swaps
that overlap would leave the second one in place for good."""


def start_server() -> viser.ViserServer:
    """Start a viser server on a free loopback port, closed to web pages.

    viser checks no origin, so that any page in the user's browser could open a websocket to it
    and bypass the relay's checks. Browsers always send an origin, the relay sends none: only
    connections without one are let in. Requests for a public tunnel, which any client may make,
    are ignored.
    """
    closed = functools.partial(websockets.asyncio.server.serve, origins=[None])
    with quiet(), _swapped_serve(closed):
        server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    server.request_share_url = no_public_tunnel  # type: ignore[method-assign]
    return server


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Swallow the banner that viser prints even when told not to be verbose."""
    with _ONE_AT_A_TIME, contextlib.redirect_stdout(io.StringIO()):
        yield


def no_public_tunnel(*_: object, **__: object) -> None:
    """Stand in for viser's request for a public tunnel."""


@contextlib.contextmanager
def _swapped_serve(serve: functools.partial[websockets.asyncio.server.serve]) -> Iterator[None]:
    """Have viser, which takes no such option, serve with what is given; it is up on return."""
    original = websockets.asyncio.server.serve
    websockets.asyncio.server.serve = serve  # type: ignore[assignment, misc]
    try:
        yield
    finally:
        websockets.asyncio.server.serve = original  # type: ignore[misc]
