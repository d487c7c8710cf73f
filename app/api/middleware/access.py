"""ASGI middleware: checks host name, origin and token of every request.

It is plain ASGI, for HTTP and websockets alike. A browser lets every web page send requests to
127.0.0.1, and with DNS rebinding the page can even read the answers. Therefore `Host` must be ours,
a request that changes something must come from our own page (Fetch Metadata and `Origin`, no CSRF
tokens), and a websocket, which no same-origin policy covers, must send our own `Origin`.
"""

from __future__ import annotations

import time
from collections import OrderedDict, deque
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qsl, urlencode, urlsplit

from starlette.datastructures import Headers
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.http.problems import ProblemError, problem_of
from app.api.http.websockets import POLICY_VIOLATION
from app.api.middleware.identities import ANYBODY, Identities, Identity
from app.settings import Settings, is_loopback
from app.store import StoreError

COOKIE = "osg_studio_session"
COOKIE_SECONDS = 30 * 24 * 60 * 60
"""Lifetime of the session cookie: a month, the length of a project to design gestures."""


OPEN_PATHS = frozenset({"/healthz", "/api/v1/healthz"})
"""Paths that are answered without a token, for monitoring."""

MOST_GUESSES = 20
"""Wrong tokens that one address may send within `GUESS_SECONDS`; several people may share it."""

GUESS_SECONDS = 60.0

MOST_ADDRESSES = 4096
"""Addresses whose wrong tokens are remembered."""

SIGN_IN = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>OSG Studio: sign in</title>
<h1>OSG Studio</h1>
<form action="/" method="get">
<p><label>Token <input name="token" type="password" required autofocus
autocomplete="current-password"></label> <button>Sign in</button></p>
</form>
<p>This server wants a token. Ask whoever runs it for one.</p>
</html>
"""
"""Page shown to a browser that has no session; it works without scripts and styles."""

SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


class SameOrigin:
    """Refuses requests under foreign host names and from foreign pages.

    Parameters
    ----------
    app
        What to guard.
    settings
        Settings with our host names.

    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self._app = app
        self._hosts = {settings.host.strip("[]").lower()}
        self._hosts |= {host.strip("[]").lower() for host in settings.allowed_hosts}
        # A server that listens on all addresses cannot know its own names. There the token protects
        # against rebinding, because its cookie belongs to the real host name.
        self._any_host = settings.host in {"0.0.0.0", "::"} and not settings.allowed_hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on requests of the right host and origin."""
        if scope["type"] in ("http", "websocket") and (reason := self._refusal(scope)):
            await _refuse(ProblemError(403, "foreign_origin", reason), scope, receive, send)
        else:
            await self._app(scope, receive, send)

    def _refusal(self, scope: Scope) -> str | None:
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if not self._is_ours(host):
            return (
                f"the host name {host[:80]!r} is not this server's; open it under the address it "
                "printed at start, or add the name to OSG_ALLOWED_HOSTS"
            )
        origin = headers.get("origin")
        if origin is not None and urlsplit(origin).netloc.lower() != host.lower():
            return f"the page {origin[:80]!r} is another site; only this server's pages may do this"
        site = headers.get("sec-fetch-site", "none")
        if site in ("none", "same-origin"):
            return None
        changes = scope["type"] == "websocket" or scope["method"] not in SAFE_METHODS
        if changes or not _is_navigation(headers):
            return "another site asked for this; only this server's pages may"
        return None

    def _is_ours(self, host: str) -> bool:
        try:
            name = urlsplit(f"//{host}").hostname or ""
        except ValueError:
            return False
        return (self._any_host and bool(name)) or name in self._hosts or is_loopback(name)


def _is_navigation(headers: Headers) -> bool:
    """Return whether a person followed a link to a page of ours."""
    return (
        headers.get("sec-fetch-mode") == "navigate" and headers.get("sec-fetch-dest") == "document"
    )


class Guesses:
    """Counts wrong tokens by address."""

    def __init__(self) -> None:
        self._times: OrderedDict[str, deque[float]] = OrderedDict()

    def add(self, client: str) -> None:
        """Count a wrong token."""
        times = self._times.pop(client, deque(maxlen=MOST_GUESSES))
        times.append(time.monotonic())
        self._times[client] = times
        if len(self._times) > MOST_ADDRESSES:
            self._times.popitem(last=False)

    def too_many(self, client: str) -> bool:
        """Return whether an address has to wait before its next guess."""
        times = self._times.get(client)
        if times is None or len(times) < MOST_GUESSES:
            return False
        return time.monotonic() - times[0] < GUESS_SECONDS


class TokenRequired:
    """Requires a token: as bearer, or in the cookie that ``/?token=`` sets.

    It stores the identity of the token in the scope, see `identities.identity_of`.

    Parameters
    ----------
    app
        What to guard.
    settings
        Settings with the tokens; without any, everybody who reaches the server has access.

    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self._app = app
        self._identities = Identities(settings)
        self._guesses = Guesses()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on requests with a token."""
        if scope["type"] not in ("http", "websocket"):
            return await self._app(scope, receive, send)
        try:
            answer = self._answer(scope)
        except StoreError as error:
            return await _refuse(problem_of(error), scope, receive, send)
        match answer:
            case Identity():
                scope.setdefault("state", {})["identity"] = answer
                return await self._app(scope, receive, send)
            case ProblemError():
                return await _refuse(answer, scope, receive, send)
            case Response():
                return await answer(scope, receive, send)

    def _answer(self, scope: Scope) -> Identity | ProblemError | Response:
        """Return the sender of a request, or the answer that refuses or redirects it."""
        if scope["path"] in OPEN_PATHS or not self._identities.required:
            return ANYBODY
        headers = Headers(scope=scope)
        if (found := self._of_session(headers)) is not None:
            return found
        client = scope["client"][0] if scope.get("client") else "local"
        if self._guesses.too_many(client):
            # The token is not compared, so that many simultaneous guesses reveal nothing more.
            detail = "too many wrong tokens came from this address; try again in a minute"
            again = {"Retry-After": f"{GUESS_SECONDS:.0f}"}
            return ProblemError(429, "too_many_guesses", detail, headers=again)
        if (found := self._of_bearer(headers)) is not None:
            return found
        if (response := self._welcome(scope)) is not None:
            return response
        detail = (
            "this server wants a token; open it as /?token=..., or send the header "
            "'Authorization: Bearer ...'"
        )
        if "authorization" in headers or b"token=" in scope["query_string"]:
            self._guesses.add(client)
        challenge = {"WWW-Authenticate": "Bearer"}
        if scope["path"] == "/" and "text/html" in headers.get("accept", ""):
            return HTMLResponse(SIGN_IN, 401, headers=challenge)
        return ProblemError(401, "token_required", detail, headers=challenge)

    def _of_bearer(self, headers: Headers) -> Identity | None:
        scheme, _, shown = headers.get("authorization", "").partition(" ")
        return self._identities.of_token(shown.strip()) if scheme.lower() == "bearer" else None

    def _of_session(self, headers: Headers) -> Identity | None:
        try:
            cookie = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
        except CookieError:
            return None
        return None if cookie is None else self._identities.of_session(cookie.value)

    def _welcome(self, scope: Scope) -> Response | None:
        """Exchange ``?token=`` in a page's address for the cookie, and redirect without it."""
        if scope["type"] != "http" or scope["method"] != "GET":
            return None
        query = parse_qsl(scope["query_string"].decode("latin-1"))
        shown = dict(query).get("token", "")
        if self._identities.of_token(shown) is None:
            return None
        rest = urlencode([(name, value) for name, value in query if name != "token"])
        # Only one leading slash, because `//host` would be another site.
        path = "/" + scope["path"].lstrip("/")
        response = RedirectResponse(f"{path}?{rest}" if rest else path, 303)
        response.set_cookie(
            COOKIE,
            self._identities.session(shown),
            max_age=COOKIE_SECONDS,
            httponly=True,
            samesite="strict",
            secure=scope["scheme"] == "https",
        )
        return response


async def _refuse(problem: ProblemError, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": POLICY_VIOLATION, "reason": problem.code})
    else:
        await problem.response()(scope, receive, send)
