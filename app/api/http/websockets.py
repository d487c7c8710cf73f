"""Websockets: close codes, the check of the Origin header, and work in two directions."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import Any, Final
from urllib.parse import urlsplit

from fastapi import WebSocket
from starlette.websockets import WebSocketDisconnect

UNSUPPORTED_DATA: Final = 1007
POLICY_VIOLATION: Final = 1008
SERVICE_RESTART: Final = 1012
"""Close code (RFC 6455, 7.4.1, and its registry)."""


def same_origin(websocket: WebSocket) -> bool:
    """Return whether the page that opens the websocket is from this server.

    Browsers send Origin with every websocket, but let scripts of other sites open websockets. Other
    programs need not send it.
    """
    origin = websocket.headers.get("origin")
    return origin is None or urlsplit(origin).netloc == websocket.headers.get("host")


async def until_one_ends(*directions: Coroutine[Any, Any, None]) -> None:
    """Await coroutines until the first one ends, and end the others.

    What one of them raises is raised, unless it is that the page has left.
    """
    tasks = [asyncio.create_task(direction) for direction in directions]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        ends = await asyncio.gather(*tasks, return_exceptions=True)
    for end in ends:
        if isinstance(end, Exception) and not isinstance(end, WebSocketDisconnect):
            raise end
