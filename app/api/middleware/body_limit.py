"""ASGI middleware: limits the request body by Content-Length or while streaming.

Starlette's middleware of this kind answers with plain text, not with a problem document.
"""

from __future__ import annotations

from collections.abc import Mapping

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.http.problems import ProblemError


class BodyLimit:
    """Limits request bodies by path.

    Parameters
    ----------
    app
        App that reads the bodies.
    default
        Bytes allowed.
    exceptions
        Bytes allowed for individual paths; ``/*`` at the end matches any one name.

    """

    def __init__(self, app: ASGIApp, default: int, exceptions: Mapping[str, int]) -> None:
        self._app = app
        self._default = default
        self._exceptions = dict(exceptions)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request, and count its bytes."""
        if scope["type"] != "http":
            return await self._app(scope, receive, send)
        path = scope["path"]
        place = path.rpartition("/")[0] + "/*"
        limit = self._exceptions.get(path, self._exceptions.get(place, self._default))
        stated = Headers(scope=scope).get("content-length", "")
        if stated.isdecimal() and int(stated) > limit:
            return await too_large(limit).response()(scope, receive, send)
        received = 0

        async def receive_with_limit() -> Message:
            nonlocal received
            message = await receive()
            received += len(message.get("body", b""))
            if received > limit:
                raise too_large(limit)
            return message

        return await self._app(scope, receive_with_limit, send)


def too_large(limit: int) -> ProblemError:
    """Return the problem that refuses a body of more than `limit` bytes."""
    detail = (
        f"the request is larger than the limit of {limit / 1e6:g} MB; "
        "send a shorter or smaller file"
    )
    # The rest of the body stays unread, so the connection cannot be reused.
    return ProblemError(413, "too_large", detail, headers={"Connection": "close"}, limit=limit)
