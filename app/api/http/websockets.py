"""Websockets: close codes and the check of the Origin header."""

from __future__ import annotations

from typing import Final
from urllib.parse import urlsplit

from fastapi import WebSocket

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
