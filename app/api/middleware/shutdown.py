"""Graceful shutdown: cancels jobs, answers open requests with 503, closes connections."""

from __future__ import annotations

import asyncio
import logging
import time
from functools import partial
from typing import Any

import uvicorn
from fastapi import FastAPI
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.http.problems import ProblemError
from app.api.middleware.connections import GuardedProtocol
from app.api.services.running_studio import Studio

ENDING_SECONDS = 2.0
"""Seconds for open requests at shutdown: enough for all but checks and long explanations, and the
whole shutdown must take less than ten seconds."""

SWEEP_SECONDS = 1.0
"""Seconds between two sweeps of the connections."""

FLUSH_SECONDS = 0.1
"""Seconds for the last answers, which are short, to be sent; only for clients that read."""


class OpenRequests:
    """Registry of the requests that a server is answering; `guard` is its ASGI middleware."""

    def __init__(self) -> None:
        self._tasks: set[asyncio.Task[Any]] = set()
        self._ending = False

    def guard(self, app: ASGIApp) -> ASGIApp:
        """Return an app that answers as `app`, of which the requests are registered."""
        return partial(self._answer, app)

    async def _answer(self, app: ASGIApp, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request by `app`, or with 503 when the server stops before the answer begins."""
        if scope["type"] != "http":
            return await app(scope, receive, send)
        task = asyncio.current_task()
        assert task is not None
        begun = False

        async def send_noting(message: Message) -> None:
            nonlocal begun
            begun = True
            await send(message)

        if self._ending:
            return await stopping().response()(scope, receive, send)
        self._tasks.add(task)
        try:
            await app(scope, receive, send_noting)
        except asyncio.CancelledError:
            if begun or not self._ending:
                raise
            task.uncancel()
            await stopping().response()(scope, receive, send)
        finally:
            self._tasks.discard(task)

    async def end(self, seconds: float = ENDING_SECONDS) -> None:
        """Wait for all requests; those that take longer are ended, and new ones refused."""
        self._ending = True
        if waiting := set(self._tasks):
            await asyncio.wait(waiting, timeout=seconds)
        for task in self._tasks:
            task.cancel()


class StudioServer(uvicorn.Server):
    """Server that guards its connections, and cancels jobs and ends requests before it stops.

    Parameters
    ----------
    config
        Configuration of uvicorn.
    app
        App that `config` serves, with its `OpenRequests`, its `ConnectionGuard` and, once it runs,
        its `Studio`.

    """

    def __init__(self, config: uvicorn.Config, app: FastAPI) -> None:
        config.http = GuardedProtocol
        super().__init__(config)
        self._app = app
        self._swept = 0.0
        logging.getLogger("uvicorn.error").addFilter(_is_news)

    async def on_tick(self, counter: int) -> bool:
        """Sweep the connections once a second."""
        if time.monotonic() - self._swept >= SWEEP_SECONDS:
            self._swept = time.monotonic()
            self._app.state.connections.sweep()
        return await super().on_tick(counter)

    async def shutdown(self, sockets: Any = None) -> None:
        """Cancel jobs, end event streams and open requests, and close the connections."""
        studio: Studio | None = getattr(self._app.state, "studio", None)
        if studio is not None:
            await studio.runner.stop()
            studio.broadcast.close()
        requests: OpenRequests = self._app.state.requests
        await requests.end()
        await asyncio.sleep(FLUSH_SECONDS)
        for connection in list(self.server_state.connections):
            # A client that does not read, such as a paused player, would delay the shutdown.
            if connection.transport.get_write_buffer_size():
                connection.transport.abort()
        await super().shutdown(sockets)


def stopping() -> ProblemError:
    """Return the problem with which a stopping server refuses requests."""
    detail = "the server is being stopped; try again when it is back"
    return ProblemError(503, "server_stopping", detail, headers={"Retry-After": "5"})


def _is_news(record: logging.LogRecord) -> bool:
    """Return False for errors of answers that the shutdown itself cancelled."""
    return not (record.exc_info and isinstance(record.exc_info[1], asyncio.CancelledError))
