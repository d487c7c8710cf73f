"""ASGI middleware: gives every request an id, logs and counts it."""

from __future__ import annotations

import logging
import re
import time
from typing import Final
from uuid import uuid4

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.observation.logs import FIELDS, request_id
from app.api.observation.metrics import Metrics
from app.api.services.identities import identity_of

HEADER: Final = "X-Request-ID"

METHODS: Final = frozenset({"GET", "HEAD", "OPTIONS", "POST", "PUT", "PATCH", "DELETE"})

ID: Final = re.compile(r"[A-Za-z0-9._-]{1,64}")
"""Ids accepted from a client or a proxy; others are replaced by our own."""

logger = logging.getLogger("app.requests")


class RequestLog:
    """Observes requests.

    Parameters
    ----------
    app
        App that answers the requests.
    metrics
        Counts the requests.

    """

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request under an id, which the response repeats."""
        if scope["type"] != "http":
            return await self._app(scope, receive, send)
        given = Headers(scope=scope).get(HEADER, "")
        own = given if ID.fullmatch(given) else uuid4().hex
        began = time.monotonic()

        async def send_with_id(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message)[HEADER] = own
                self._observe(scope, message["status"], time.monotonic() - began)
            await send(message)

        known = request_id.set(own)
        try:
            await self._app(scope, receive, send_with_id)
        finally:
            request_id.reset(known)

    def _observe(self, scope: Scope, status: int, seconds: float) -> None:
        route = getattr(scope.get("route"), "path", None) or "other"
        # A client may invent methods, each of which would create a permanent time series.
        method = scope["method"] if scope["method"] in METHODS else "other"
        self._metrics.requests.labels(method, route, str(status)).inc()
        self._metrics.request_seconds.labels(method, route).observe(seconds)
        fields = {
            "method": scope["method"],
            "path": scope["path"],
            "status": status,
            "seconds": round(seconds, 4),
            "address": scope["client"][0] if scope.get("client") else "local",
            "name": identity_of(scope).name,
        }
        logger.info("request answered", extra={FIELDS: fields})
