"""ASGI middleware: writes every change into the audit log, before it is acknowledged."""

from __future__ import annotations

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.http.problems import problem_of
from app.api.middleware.roles import SAFE_METHODS, needed_role
from app.api.observation.logs import request_id
from app.api.services.identities import identity_of
from app.store import AuditEntry, AuditStore, Role, StoreError

LONGEST_PATH = 300

CUT = "..."
"""Mark at the end of a query that was cut."""


class Audit:
    """Logs the changes that succeed; an upload in parts is logged once, when it is complete.

    A change that cannot be logged anywhere is answered with 503.

    Parameters
    ----------
    app
        App that makes the changes.

    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request, and log it according to the answer."""
        reads = scope["type"] != "http" or scope["method"] in SAFE_METHODS
        if reads or needed_role(scope["method"], scope["path"]) is Role.READ:
            return await self._app(scope, receive, send)
        refused = False

        async def send_after_noting(message: Message) -> None:
            nonlocal refused
            if refused:
                return
            if message["type"] == "http.response.start" and message["status"] < 400:
                is_part = scope["method"] == "PATCH" and "/uploads/" in scope["path"]
                if not is_part or "content-location" in Headers(raw=message["headers"]):
                    try:
                        await _note(scope, message["status"])
                    except StoreError as error:
                        refused = True
                        await problem_of(error).response()(scope, receive, send)
                        return
            await send(message)

        return await self._app(scope, receive, send_after_noting)


async def _note(scope: Scope, status: int) -> None:
    identity = identity_of(scope)
    entry = AuditEntry(
        name=identity.name,
        role=identity.role.value,
        address=(scope["client"][0] if scope.get("client") else "local")[:64],
        method=scope["method"],
        path=_address(scope["path"], scope["query_string"].decode("latin-1")),
        status=status,
        request_id=request_id.get(),
    )
    audit: AuditStore = scope["app"].state.studio.audit
    await run_in_threadpool(audit.add, entry)


def _address(path: str, query: str) -> str:
    """Return path and query in at most `LONGEST_PATH` characters; a cut shows at the end."""
    address = f"{path}?{query}" if query else path
    return address if len(address) <= LONGEST_PATH else address[: LONGEST_PATH - len(CUT)] + CUT
