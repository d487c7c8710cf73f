"""ASGI middleware: ends requests whose body arrives too slowly."""

from __future__ import annotations

import asyncio
import time

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.http.problems import ProblemError


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
