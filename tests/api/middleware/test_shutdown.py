"""The end of a server, as one request sees it."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
from starlette.types import Message, Receive, Scope, Send

from app.api.middleware.shutdown import OpenRequests

SCOPE: Scope = {"type": "http", "method": "GET", "path": "/", "headers": []}


async def answers_at_the_end(scope: Scope, receive: Receive, send: Send) -> None:
    await asyncio.sleep(3600)


async def answers_without_end(scope: Scope, receive: Receive, send: Send) -> None:
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await asyncio.sleep(3600)


async def asked(app: Any, requests: OpenRequests, *, seconds: float = 0.01) -> list[Message]:
    """Ask `app`, end its server, and return what was sent."""
    sent: list[Message] = []

    async def send(message: Message) -> None:
        sent.append(message)

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    request = asyncio.ensure_future(requests.guard(app)(SCOPE, receive, send))
    await asyncio.sleep(0)
    await requests.end(seconds)
    await request
    return sent


def test_what_has_no_answer_in_time_is_answered_that_the_server_stops() -> None:
    head, body = asyncio.run(asked(answers_at_the_end, OpenRequests()))
    assert head["status"] == 503
    assert b"server_stopping" in body["body"]


def test_what_comes_after_the_end_is_refused_at_once() -> None:
    async def twice() -> list[Message]:
        requests = OpenRequests()
        await requests.end()
        return await asked(answers_without_end, requests)

    head, _ = asyncio.run(twice())
    assert head["status"] == 503


def test_an_answer_that_began_is_broken_off() -> None:
    with pytest.raises(asyncio.CancelledError):
        asyncio.run(asked(answers_without_end, OpenRequests()))
