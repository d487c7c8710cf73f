"""ASGI middleware: refuses changes whose path ends in a slash.

The router redirects such a path to the one without the slash. A browser turns
``DELETE /languages/ID/gestures/..`` into ``DELETE /languages/ID/``, which must not delete the
language.
"""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.http.problems import ProblemError

_ON_ONE_THING = frozenset({"PUT", "PATCH", "DELETE"})


class NoTrailingSlash:
    """Answers 404 to a change or deletion at a path that ends in a slash.

    Parameters
    ----------
    app
        What answers all other requests.

    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what the router does not redirect."""
        changes = scope["type"] == "http" and scope["method"] in _ON_ONE_THING
        # A slash in a label is encoded, and only the raw path shows that.
        if changes and scope.get("raw_path", b"").endswith(b"/"):
            detail = "no path that ends in '/' can be changed; leave the last '/' out"
            problem = ProblemError(404, "not_found", detail)
            await problem.response()(scope, receive, send)
        else:
            await self._app(scope, receive, send)
