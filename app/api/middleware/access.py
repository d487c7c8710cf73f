"""ASGI middleware: checks framing, host name, origin and token of every request.

It is plain ASGI, for HTTP and websockets alike. A browser lets every web page send requests to
127.0.0.1, and with DNS rebinding the page can even read the answers. Therefore `Host` must be ours,
a request that changes something must come from our own page (Fetch Metadata and `Origin`, no CSRF
tokens), and a websocket, which no same-origin policy covers, must not send a foreign `Origin`.
Browsers send it with every websocket; other programs need not.
"""

from __future__ import annotations

import logging
import re
import time
from collections import OrderedDict
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from typing import Final
from urllib.parse import parse_qsl, urlencode, urlsplit

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.http.page_files import prefix_of
from app.api.http.problems import RETRY_SECONDS, ProblemError, problem_of
from app.api.http.websockets import POLICY_VIOLATION
from app.api.middleware.open_connections import OpenConnections, Proof
from app.api.middleware.roles import SAFE_METHODS
from app.api.services.identities import ANYBODY, Identities, Identity
from app.settings import Settings, is_loopback
from app.store import InvitationStore, SignInStore, StoreError
from app.store.invitations import closed
from app.store.models import SignIn
from app.store.tokens import LIFETIME, TokensUnavailable, digest

logger = logging.getLogger(__name__)

COOKIE = "osg_studio_session"
"""Name of the cookie of a session."""

OPEN_PATHS: Final = ("/healthz", "/api/v1/healthz", "/invitation")
"""Paths that, with all below them, are answered without a token: for monitoring, and the page of
invited people, whose files are the program's own."""

INVITED: Final = "/api/v1/invited"
"""Path that invited people reach, with all below it. There the token of an invitation is needed,
and elsewhere it is none."""

MOST_GUESSES: Final = 20
"""Wrong tokens that one address may send within `GUESS_SECONDS`; several people may share it."""

GUESS_SECONDS: Final = 60.0

MOST_OWN_GUESSES: Final = 1000
"""Wrong tokens within `OWN_GUESS_SECONDS` after which the token of the settings is not compared any
more: a person may have made it up, and a word list has millions of entries. A named token has 192
random bits and always passes."""

OWN_GUESS_SECONDS: Final = 3600.0

MOST_ADDRESSES: Final = 4096
"""Addresses whose wrong tokens are remembered."""

HOST: Final = re.compile(
    r"(\[[0-9a-f:.]{2,45}\]|[0-9a-z_-][0-9a-z._-]{0,252})(?::([0-9]{1,5}))?", re.IGNORECASE
)
"""A host header: an address or name, and a port; neither user, zone nor path."""

LAST_PORT: Final = 65535

CHALLENGE: Final = {"WWW-Authenticate": "Bearer"}

SIGN_IN = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>OSG Studio: sign in</title>
<h1>OSG Studio</h1>
<form action="./" method="get">
<p><label>Token <input name="token" type="password" required autofocus
autocomplete="current-password"></label> <button>Sign in</button></p>
</form>
<p>This server wants a token. Ask whoever runs it for one.</p>
</html>
"""
"""Page shown to a browser that has no session; it works without scripts and styles."""


class SameOrigin:
    """Refuses requests under foreign host names, from foreign pages, and of two lengths.

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
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
        elif _has_two_lengths(scope):
            await _refuse(two_lengths(), scope, receive, send)
        elif reason := self._refusal(scope):
            await _refuse(ProblemError(403, "foreign_origin", reason), scope, receive, send)
        else:
            await self._app(scope, receive, send)

    def _refusal(self, scope: Scope) -> str | None:
        headers = Headers(scope=scope)
        hosts = headers.getlist("host")
        host = hosts[0] if len(hosts) == 1 else ", ".join(hosts)
        if not self._is_ours(host):
            return (
                f"the host name {host[:80]!r} is not this server's; open it under the address it "
                "printed at start, or add the name to OSG_ALLOWED_HOSTS"
            )
        origin = headers.get("origin")
        if origin is not None and _host_of(origin) != host.lower():
            return f"the page {origin[:80]!r} is another site; only this server's pages may do this"
        site = headers.get("sec-fetch-site", "none")
        if site in ("none", "same-origin"):
            return None
        changes = scope["type"] == "websocket" or scope["method"] not in SAFE_METHODS
        if changes or not _is_navigation(headers):
            return "another site asked for this; only this server's pages may"
        return None

    def _is_ours(self, host: str) -> bool:
        read = HOST.fullmatch(host)
        if read is None or not 1 <= int(read[2] or 1) <= LAST_PORT:
            return False
        name = read[1].strip("[]").lower()
        return self._any_host or name in self._hosts or is_loopback(name)


def _host_of(origin: str) -> str:
    """Return host and port of an origin; empty if it is malformed, as only a program sends it."""
    try:
        return urlsplit(origin).netloc.lower()
    except ValueError:
        return ""


def _has_two_lengths(scope: Scope) -> bool:
    """Return whether a body's end is stated twice, which a proxy may read otherwise."""
    names = [name for name, _ in scope["headers"]]
    lengths = names.count(b"content-length")
    return lengths > 1 or (lengths == 1 and b"transfer-encoding" in names)


def two_lengths() -> ProblemError:
    """Return the problem that refuses a request whose body's end is stated twice."""
    detail = "the length of the body is stated twice; send Content-Length or Transfer-Encoding"
    return ProblemError(400, "bad_request", detail, headers={"Connection": "close"})


def _is_navigation(headers: Headers) -> bool:
    """Return whether a person followed a link to a page of ours."""
    return (
        headers.get("sec-fetch-mode") == "navigate" and headers.get("sec-fetch-dest") == "document"
    )


class Guesses:
    """Counts wrong tokens by address.

    Parameters
    ----------
    most, seconds
        Wrong tokens that an address may send within this time, before it has to wait.

    """

    def __init__(self, most: int, seconds: float) -> None:
        self._most, self._seconds = most, seconds
        self._counts: OrderedDict[str, tuple[float, int]] = OrderedDict()

    def add(self, client: str) -> None:
        """Count a wrong token."""
        began, count = self._counts.pop(client, (time.monotonic(), 0))
        if time.monotonic() - began >= self._seconds:
            began, count = time.monotonic(), 0
        self._counts[client] = began, count + 1
        if len(self._counts) > MOST_ADDRESSES:
            self._counts.popitem(last=False)

    def too_many(self, client: str) -> bool:
        """Return whether an address has to wait before its next guess."""
        began, count = self._counts.get(client, (0.0, 0))
        return count >= self._most and time.monotonic() - began < self._seconds


class TokenRequired:
    """Requires a token: as bearer, or in a session that ``/?token=`` begins.

    It stores the identity of the token in the scope, see `identities.identity_of`, and ends open
    connections once token or session are not valid any more.

    Parameters
    ----------
    app
        What to guard.
    settings
        Settings with the tokens; if there never were any, everybody on this machine has access.

    """

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self._app = app
        self._settings = settings
        self._identities = Identities(settings)
        self._connections = OpenConnections(self._identities)
        self._guesses = Guesses(MOST_GUESSES, GUESS_SECONDS)
        self._own_guesses = Guesses(MOST_OWN_GUESSES, OWN_GUESS_SECONDS)
        self._told = ""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on requests with a token."""
        if scope["type"] not in ("http", "websocket") or _is_below(scope["path"], *OPEN_PATHS):
            return await self._app(scope, receive, send)
        sign_ins: SignInStore = scope["app"].state.studio.sign_ins
        answer: tuple[Identity, Proof] | ProblemError | Response
        try:
            if _is_below(scope["path"], INVITED):
                answer = await self._answer_invited(scope)
            else:
                answer = await self._answer(scope, sign_ins)
        except TokensUnavailable as error:
            answer = self._no_list(error)
        except StoreError as error:
            answer = problem_of(error)
        match answer:
            case (identity, proof):
                scope.setdefault("state", {})["identity"] = identity
                return await self._connections.answer(self._app, scope, receive, send, proof=proof)
            case ProblemError():
                return await _refuse(answer, scope, receive, send)
            case Response():
                return await answer(scope, receive, send)

    async def _answer(
        self, scope: Scope, sign_ins: SignInStore
    ) -> tuple[Identity, Proof] | ProblemError | Response:
        """Return the sender of a request, or the answer that refuses or redirects it."""
        if not self._identities.required:
            return ANYBODY, Proof()
        headers = Headers(scope=scope)
        client = scope["client"][0] if scope.get("client") else "local"
        cookie = cookie_of(headers)
        known = None
        if cookie and (session := await _session_of(cookie, sign_ins)) is not None:
            known = self._identities.of_session(cookie, session)
        if known is None and "authorization" in headers:
            scheme, _, bearer = headers["authorization"].partition(" ")
            shown_digest = digest(bearer.strip()) if scheme.lower() == "bearer" else ""
            found = self._of_token(shown_digest, client)
            return (found, Proof(token=shown_digest)) if isinstance(found, Identity) else found
        if (shown := _shown_in_address(scope)) is not None:
            return await self._sign_in(scope, shown, known, client, sign_ins)
        if known is not None:
            return known, Proof(cookie=cookie)
        return _page_or(scope, self._no_token())

    async def _sign_in(
        self, scope: Scope, shown: str, known: Identity | None, client: str, sign_ins: SignInStore
    ) -> ProblemError | Response:
        """Exchange the token in a page's address for a session, and redirect without the token."""
        found = self._of_token(digest(shown), client)
        if isinstance(found, ProblemError) and known is None:
            return _page_or(scope, found)
        response = _redirect_without_token(scope)
        if isinstance(found, Identity) and found != known:
            cookie = await run_in_threadpool(sign_ins.begin, found.name, digest(shown))
            response.set_cookie(
                COOKIE,
                cookie,
                max_age=int(LIFETIME.total_seconds()),
                httponly=True,
                samesite="strict",
                secure=scope["scheme"] == "https",
                # Another studio of the same host name keeps its own.
                path=f"{prefix_of(Headers(scope=scope), self._settings)}/",
            )
        return response

    async def _answer_invited(self, scope: Scope) -> tuple[Identity, Proof] | ProblemError:
        """Return in whose name the sender of an invited take acts, or the answer that refuses it.

        Neither a session nor any other token counts here, so that the page of invited people shows
        the same to everybody.
        """
        scheme, _, shown = Headers(scope=scope).get("authorization", "").partition(" ")
        if scope["type"] == "websocket":
            # Browsers send no such header with it, but the subprotocols that the page wants.
            scheme, shown = "bearer", scope["subprotocols"][-1] if scope["subprotocols"] else ""
        invitations: InvitationStore = scope["app"].state.studio.invitations
        token = digest(shown.strip() if scheme.lower() == "bearer" else "")
        found = await run_in_threadpool(invitations.find, token)
        if found is None:
            client = scope["client"][0] if scope.get("client") else "local"
            waits = self._guesses.too_many(client)
            self._guesses.add(client)
            if waits:
                return _too_many(GUESS_SECONDS, "a minute")
            detail = "this is no invitation; open the whole link, or scan its code again"
            return ProblemError(401, "invitation_unknown", detail, headers=CHALLENGE)
        owner = self._identities.of_inviter(found.owner, found.created)
        if found.closed or owner is None:
            return problem_of(closed(found.closed or "withdrawn"))
        scope.setdefault("state", {})["invitation"] = found
        return owner, Proof(invitation=token)

    def _of_token(self, shown: str, client: str) -> Identity | ProblemError:
        """Return the identity of a token by its digest; count and refuse a wrong one."""
        # Compared even when too many wrong ones came from this address, which others may share: the
        # right one passes, and its digest cannot be found by simultaneous guesses.
        found = self._identities.of_token(shown)
        may_be_guessed = self._identities.is_own(shown) and self._own_guesses.too_many(client)
        if found is not None and not may_be_guessed:
            return found
        waits = self._guesses.too_many(client)
        if found is None:
            self._guesses.add(client)
            self._own_guesses.add(client)
        if not waits and not may_be_guessed:
            return self._no_token()
        if may_be_guessed:
            return _too_many(OWN_GUESS_SECONDS, "an hour")
        return _too_many(GUESS_SECONDS, "a minute")

    def _no_list(self, error: TokensUnavailable) -> ProblemError:
        """Return the refusal of everybody; the reason, which names a path, is for the log."""
        if str(error) != self._told:
            self._told = str(error)
            logger.error("%s", error)
        detail = (
            "this server's list of tokens cannot be used, so nobody is let in; whoever runs it "
            "finds the reason in its log"
        )
        headers = {"Retry-After": RETRY_SECONDS}
        return ProblemError(503, "store_unavailable", detail, headers=headers)

    def _no_token(self) -> ProblemError:
        detail = (
            "this server wants a token; open it as /?token=..., or send the header "
            "'Authorization: Bearer ...'"
        )
        if self._identities.nobody:
            detail = (
                "this server lets nobody in, because it has no tokens any more; whoever runs it "
                "adds one with: osg-studio tokens add"
            )
        return ProblemError(401, "token_required", detail, headers=CHALLENGE)


def _is_below(path: str, *places: str) -> bool:
    return any(path == place or path.startswith(f"{place}/") for place in places)


def _too_many(seconds: float, words: str) -> ProblemError:
    detail = f"too many wrong tokens came from this address; try again in {words}"
    again = {"Retry-After": f"{seconds:.0f}"}
    return ProblemError(429, "too_many_guesses", detail, headers=again)


def _page_or(scope: Scope, problem: ProblemError) -> ProblemError | Response:
    """Return the page to sign in where a person asked for the page, else the problem."""
    html = "text/html" in Headers(scope=scope).get("accept", "")
    if scope["path"] != "/" or not html or problem.status_code != HTTPStatus.UNAUTHORIZED:
        return problem
    return HTMLResponse(SIGN_IN, HTTPStatus.UNAUTHORIZED, headers=CHALLENGE)


async def _session_of(cookie: str, sign_ins: SignInStore) -> SignIn | None:
    if (found := sign_ins.cached(cookie)) is not None:
        return found
    return (await run_in_threadpool(sign_ins.find, [cookie])).get(cookie)


def cookie_of(headers: Headers) -> str:
    """Return the cookie of a session; empty if there is none."""
    try:
        cookie = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
    except CookieError:
        return ""
    return "" if cookie is None else cookie.value


def _shown_in_address(scope: Scope) -> str | None:
    """Return the token in the address of a page that is opened; None if there is none."""
    if scope["type"] != "http" or scope["method"] != "GET":
        return None
    return dict(parse_qsl(scope["query_string"].decode("latin-1"))).get("token")


def _redirect_without_token(scope: Scope) -> Response:
    query = parse_qsl(scope["query_string"].decode("latin-1"))
    rest = urlencode([(name, value) for name, value in query if name != "token"])
    # Relative, for a reverse proxy may have taken a prefix away, and `//host` is another site.
    path = "./" + scope["path"].rpartition("/")[2]
    return RedirectResponse(f"{path}?{rest}" if rest else path, HTTPStatus.SEE_OTHER)


async def _refuse(problem: ProblemError, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": POLICY_VIOLATION, "reason": problem.code})
    else:
        await problem.response()(scope, receive, send)
