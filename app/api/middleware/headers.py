"""ASGI middleware: security headers, with a strict policy for what users uploaded."""

from __future__ import annotations

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

PAGE_POLICY = (
    "default-src 'self'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "media-src 'self' blob:; connect-src 'self'; frame-src 'self'; object-src 'none'; "
    "base-uri 'none'; frame-ancestors 'self'; form-action 'self'"
)
"""Content security policy of the page. `connect-src` also keeps viser's client, which obeys
``?websocket=`` in its address, from talking to other servers."""

DATA_POLICY = "default-src 'none'; sandbox; frame-ancestors 'self'"
"""Policy of users' files (videos, pictures, exports): nothing in them may run."""

_COMMON = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(self), microphone=(), geolocation=()",
}


class SecurityHeaders:
    """Adds the headers to every answer; a header that a route has set stays.

    Parameters
    ----------
    app
        App that answers.

    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request, and add the headers to the answer."""
        if scope["type"] != "http":
            return await self._app(scope, receive, send)
        api = scope["path"].startswith("/api/")
        defaults = {"Content-Security-Policy": DATA_POLICY if api else PAGE_POLICY, **_COMMON}
        if api:
            defaults["Cache-Control"] = "no-store"

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in defaults.items():
                    headers.setdefault(name, value)
            await send(message)

        return await self._app(scope, receive, send_with_headers)
