"""ASGI middleware for request bodies: limits their size and pace, and refuses ambiguous JSON."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Collection, Mapping
from contextlib import suppress

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.http.problems import Fault, ProblemError
from app.recognition.text.strict_json import StrictJSONError, read_json

SMALL_BYTES = 16 * 1024
"""A body up to this size is awaited before an answer, and parsed on the event loop."""


def stated_bytes(headers: Headers) -> int:
    """Return the length that a request states of its body; 0 if it states none."""
    stated = headers.get("content-length", "")
    return int(stated) if stated.isdecimal() else 0


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
        if stated_bytes(Headers(scope=scope)) > limit:
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


class BodyPace:
    """Limits the time between two pieces of a request's body, and its average rate.

    Parameters
    ----------
    app
        App that reads the bodies.
    grace_seconds
        Longest pause, and the time before the rate is checked.
    bytes_per_second
        Slowest rate; 0 tolerates any.

    """

    def __init__(self, app: ASGIApp, grace_seconds: float, bytes_per_second: int) -> None:
        self._app = app
        self._grace_seconds = grace_seconds
        self._bytes_per_second = bytes_per_second

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request, and check the time between pieces of its body."""
        if scope["type"] != "http":
            return await self._app(scope, receive, send)
        began, received, complete = time.monotonic(), 0, False

        async def receive_in_time() -> Message:
            nonlocal received, complete
            if complete:
                return await receive()  # the end of the connection, whenever that is
            try:
                async with asyncio.timeout(self._grace_seconds):
                    message = await receive()
            except TimeoutError as error:
                raise too_slow() from error
            received += len(message.get("body", b""))
            complete = not message.get("more_body", False)
            excess = time.monotonic() - began - self._grace_seconds
            if not complete and excess > 0 and received < excess * self._bytes_per_second:
                raise too_slow()
            return message

        return await self._app(scope, receive_in_time, send)


def too_slow() -> ProblemError:
    """Return the problem that refuses a body that comes too slowly."""
    detail = "the upload came too slowly and was ended; try again on a better connection"
    return ProblemError(408, "upload_too_slow", detail, headers={"Connection": "close"})


REST_SECONDS = 1.0
"""How long an answer waits for the rest of a small body."""


class AnswerAfterBody:
    """Receives the rest of a small body before an answer, for instance before a refusal.

    Caddy, like every proxy on Go's HTTP client, may lose an answer that begins while it is still
    sending the request.

    Parameters
    ----------
    app
        App that may answer before it has read the body.

    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request, and the answer once a small body is complete."""
        length = stated_bytes(Headers(scope=scope)) if scope["type"] == "http" else 0
        if not 0 < length <= SMALL_BYTES:
            return await self._app(scope, receive, send)
        complete = False

        async def receive_until_complete() -> Message:
            nonlocal complete
            message = await receive()
            complete = not message.get("more_body", False)
            return message

        async def send_after_body(message: Message) -> None:
            nonlocal complete
            with suppress(TimeoutError):
                async with asyncio.timeout(REST_SECONDS):
                    while not complete:
                        await receive_until_complete()
            complete = True
            await send(message)

        return await self._app(scope, receive_until_complete, send_after_body)


class KnownKeys:
    """Refuses an ``Idempotency-Key`` where it is not understood: a retry would rely on it in vain.

    Parameters
    ----------
    app
        App that answers.
    understood
        Paths whose POST understands the key.

    """

    def __init__(self, app: ASGIApp, understood: Collection[str]) -> None:
        self._app = app
        self._understood = frozenset(understood)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request, or refuse it."""
        is_sent = scope["type"] == "http" and "idempotency-key" in Headers(scope=scope)
        if is_sent and scope["method"] == "POST" and scope["path"] not in self._understood:
            known = ", ".join(sorted(self._understood))
            detail = f"an Idempotency-Key is understood by POST {known} only: leave it out"
            problem = ProblemError(422, "idempotency_key_unknown", detail)
            return await problem.response()(scope, receive, send)
        return await self._app(scope, receive, send)


class StrictBodies:
    """Checks JSON bodies while they are received.

    Parameters
    ----------
    app
        App that reads the bodies; the problem is raised in its call of `receive`.
    most_bytes
        Size of the largest body, which an outer middleware must enforce.
    exceptions
        Paths whose routes check the bodies themselves.

    """

    def __init__(self, app: ASGIApp, most_bytes: int, exceptions: Collection[str]) -> None:
        self._app = app
        self._most_bytes = most_bytes
        self._exceptions = frozenset(exceptions)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on the request, and check a copy of a JSON body."""
        if scope["type"] != "http" or scope["path"] in self._exceptions or not _is_json(scope):
            return await self._app(scope, receive, send)
        pieces: list[bytes] = []
        complete = False

        async def receive_and_check() -> Message:
            nonlocal complete
            message = await receive()
            if not complete and message["type"] == "http.request":
                pieces.append(message.get("body", b""))
                complete = not message.get("more_body", False)
                if complete and (body := b"".join(pieces)):
                    await self._check(body)
            return message

        return await self._app(scope, receive_and_check, send)

    async def _check(self, body: bytes) -> None:
        try:
            if len(body) <= SMALL_BYTES:
                read_json(body, self._most_bytes)
            else:
                await run_in_threadpool(read_json, body, self._most_bytes)
        except StrictJSONError as error:
            faults = [Fault(pointer=each.pointer, detail=each.message) for each in error.faults]
            words = "; ".join(f"{each.pointer or 'body'}: {each.detail}" for each in faults[:3])
            detail = f"the request is not valid: {words}"
            raise ProblemError(422, "request_invalid", detail, errors=faults) from error


def _is_json(scope: Scope) -> bool:
    kind, _, _ = Headers(scope=scope).get("content-type", "").partition(";")
    kind = kind.strip().lower()
    return kind == "application/json" or (
        kind.startswith("application/") and kind.endswith("+json")
    )
