"""ASGI middleware: refuses JSON bodies that programs understand differently.

Of two equal keys Python's parser takes the last, others the first, and it accepts NaN and exact
large integers, which others round. The import of a language file parses the file itself, as
strictly.
"""

from __future__ import annotations

from collections.abc import Collection

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.http.problems import Fault, ProblemError
from app.recognition.text.strict_json import StrictJSONError, read_json

SMALL_BYTES = 16 * 1024
"""Bodies up to this size are parsed on the event loop, in a millisecond."""


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
