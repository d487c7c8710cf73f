"""ASGI middleware: refuses requests that a token's role does not allow."""

from __future__ import annotations

import re
from typing import Final

from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.http.problems import ProblemError
from app.api.services.identities import identity_of
from app.store import Role

SAFE_METHODS: Final = frozenset({"GET", "HEAD", "OPTIONS"})
"""Methods that change nothing."""

ADMIN_PATHS: Final = frozenset({"/metrics", "/api/v1/audit"})

READING: Final = re.compile(
    r"/api/v1/(recognitions|session|workspaces(/.*)?|clips/[^/]+/session\.mcap"
    r"|languages/[^/]+/(preview(/health)?|take-table))"
)
"""Paths at which no method changes what others see: a recognition is a new record, a workspace is
the picture of one browser tab, and an exported session is written for its sender."""


class RoleRequired:
    """Answers 403 if the role of the request's token is not sufficient.

    Parameters
    ----------
    app
        App that answers all other requests.

    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on allowed requests."""
        if scope["type"] == "http":
            identity, needed = identity_of(scope), needed_role(scope["method"], scope["path"])
            if not includes(identity.role, needed):
                detail = (
                    f"the token {identity.name!r} has the role {identity.role.value}, and this "
                    f"needs {needed.value}; ask an administrator for such a token"
                )
                problem = ProblemError(403, "role_required", detail, role=needed.value)
                return await problem.response()(scope, receive, send)
        return await self._app(scope, receive, send)


def includes(role: Role, needed: Role) -> bool:
    """Return whether a role allows what `needed` allows."""
    roles = [*Role]
    return roles.index(role) >= roles.index(needed)


def needed_role(method: str, path: str) -> Role:
    """Return the lowest role that a request needs."""
    if path in ADMIN_PATHS:
        return Role.ADMIN
    if method in SAFE_METHODS or READING.fullmatch(path):
        return Role.READ
    return Role.EDIT
