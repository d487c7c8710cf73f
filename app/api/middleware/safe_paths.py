"""ASGI middleware: answers 404 to paths with a NUL byte, and to ambiguous ones.

The router redirects a path that ends in a slash to the one without it. A browser turns
``DELETE /languages/ID/gestures/..`` into ``DELETE /languages/ID/``, which must not delete the
language. No id contains a NUL, and some databases refuse queries with one.
"""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.http.problems import ProblemError

_ON_ONE_THING = frozenset({"PUT", "PATCH", "DELETE"})


class SafePaths:
    """Answers 404 to a change at a path that ends in a slash, and to a path with a NUL.

    Parameters
    ----------
    app
        App that answers all other requests.

    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on requests with a safe path."""
        if scope["type"] != "http":
            return await self._app(scope, receive, send)
        # A slash in a label is encoded, and only the raw path shows that.
        slash = scope.get("raw_path", b"").endswith(b"/")
        if (slash and scope["method"] in _ON_ONE_THING) or "\0" in scope["path"]:
            detail = "there is nothing at this path; leave a '/' at its end out"
            return await ProblemError(404, "not_found", detail).response()(scope, receive, send)
        return await self._app(scope, receive, send)
