"""ASGI middleware: writes every change into the audit log, before it is acknowledged."""

from __future__ import annotations

import logging

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.middleware.access import SAFE_METHODS
from app.api.middleware.identities import identity_of
from app.api.middleware.roles import needed_role
from app.api.observation.logs import FIELDS, request_id
from app.store import AuditEntry, AuditStore, Role, StoreError

LONGEST_PATH = 300

logger = logging.getLogger(__name__)


class Audit:
    """Logs the changes that succeed; an upload in parts is logged once, when it is complete.

    Parameters
    ----------
    app
        App that makes the changes.

    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request, and log it according to the answer."""
        if scope["type"] != "http" or needed_role(scope["method"], scope["path"]) is Role.READ:
            return await self._app(scope, receive, send)
        if scope["method"] in SAFE_METHODS:
            return await self._app(scope, receive, send)

        async def send_after_noting(message: Message) -> None:
            if message["type"] == "http.response.start" and message["status"] < 400:
                is_part = scope["method"] == "PATCH" and "/uploads/" in scope["path"]
                if not is_part or "content-location" in Headers(raw=message["headers"]):
                    await _note(scope, message["status"])
            await send(message)

        return await self._app(scope, receive, send_after_noting)


async def _note(scope: Scope, status: int) -> None:
    identity = identity_of(scope)
    query = scope["query_string"].decode("latin-1")
    path = scope["path"] + (f"?{query}" if query else "")
    entry = AuditEntry(
        name=identity.name,
        role=identity.role.value,
        address=(scope["client"][0] if scope.get("client") else "local")[:64],
        method=scope["method"],
        path=path[:LONGEST_PATH],
        status=status,
        request_id=request_id.get(),
    )
    fields = entry.model_dump(exclude={"id", "time"})
    audit: AuditStore = scope["app"].state.studio.audit
    try:
        await run_in_threadpool(audit.add, entry)
    except StoreError:
        # The change is made and must be acknowledged; the process log then has the entry instead.
        logger.exception("a change could not be written to the audit log", extra={FIELDS: fields})
