"""Reverse proxy for viser: one public port, viser itself on loopback only.

viser's client is one HTML file whose websocket URL is the page's own without query and trailing
slash: a page at ``/viser/abc/`` opens ``ws://host/viser/abc``. Therefore two routes are enough.
viser checks neither origin nor token; both are checked here.
"""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Final

import viser
import websockets
from fastapi import APIRouter, WebSocket
from fastapi.responses import FileResponse
from starlette.websockets import WebSocketDisconnect
from websockets.asyncio.client import ClientConnection
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from app.api.http.websockets import (
    POLICY_VIOLATION,
    SERVICE_RESTART,
    same_origin,
    until_one_ends,
)
from app.api.viser_workspaces.routes import CurrentWorkspaces, Owner, no_workspace
from app.ui.loopback_server import RELAY_HEADERS

CLIENT: Final = Path(viser.__file__).parent / "client" / "build" / "index.html"

CONTENT_SECURITY_POLICY: Final = (
    "default-src 'none'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:; "
    "worker-src 'self' blob:; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "font-src 'self' data:; connect-src 'self' data: blob:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'self'"
)
"""Policy of viser's page only, which is one file with inline scripts and compiles WebAssembly.

``connect-src 'self'`` matters most: without it a link with ``?websocket=ws://...`` would let a
foreign server draw into our page.
"""


router = APIRouter(prefix="/viser", include_in_schema=False)


@router.get("/{name}/")
def get_viser_page(name: str, workspaces: CurrentWorkspaces, owner: Owner) -> FileResponse:
    """Send viser's client, whose address names the workspace."""
    if workspaces.port_of(name, owner) is None:
        raise no_workspace()
    headers = {
        "Content-Security-Policy": CONTENT_SECURITY_POLICY,
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
    }
    return FileResponse(CLIENT, media_type="text/html", headers=headers)


@router.websocket("/{name}")
async def relay_viser(
    name: str, browser: WebSocket, workspaces: CurrentWorkspaces, owner: Owner
) -> None:
    """Pass messages between a page and the viser server of its workspace."""
    port = workspaces.port_of(name, owner)
    if port is None or not same_origin(browser):
        await browser.close(code=POLICY_VIOLATION)
        return
    with contextlib.suppress(OSError, websockets.InvalidHandshake):
        async with _connect(port, browser.scope.get("subprotocols", [])) as server:
            await browser.accept(subprotocol=server.subprotocol)
            await until_one_ends(_to_viser(browser, server), _to_browser(server, browser))
    with contextlib.suppress(RuntimeError, WebSocketDisconnect):
        await browser.close(code=SERVICE_RESTART)


def _connect(port: int, subprotocols: list[str]) -> websockets.connect:
    """Connect to viser, without compression or size limit, because both ends are this machine."""
    return websockets.connect(
        f"ws://127.0.0.1:{port}",
        subprotocols=[Subprotocol(name) for name in subprotocols] or None,
        additional_headers=RELAY_HEADERS,
        compression=None,
        max_size=None,
        proxy=None,
        ping_interval=None,
    )


async def _to_viser(browser: WebSocket, server: ClientConnection) -> None:
    with contextlib.suppress(ConnectionClosed, KeyError, RuntimeError):
        while True:
            await server.send(await browser.receive_bytes())


async def _to_browser(server: ClientConnection, browser: WebSocket) -> None:
    with contextlib.suppress(ConnectionClosed, RuntimeError):
        async for message in server:
            await browser.send_bytes(message if isinstance(message, bytes) else message.encode())
