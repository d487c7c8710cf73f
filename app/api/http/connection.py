"""Connection of a request: ends work whose client has left."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Coroutine
from functools import partial
from typing import Any, TypeVar

from starlette.requests import ClientDisconnect, Request

from app.api.jobs.job import compute_in_place

Result = TypeVar("Result")


async def while_connected(request: Request, work: Coroutine[Any, Any, Result]) -> Result:
    """Await `work` while the client waits for it; the request's body must have been read.

    Raises
    ------
    ClientDisconnect
        When the client has left; `work` is cancelled.

    """
    working = asyncio.create_task(work)
    leaving = asyncio.create_task(_disconnect(request))
    try:
        await asyncio.wait([working, leaving], return_when=asyncio.FIRST_COMPLETED)
        if working.done():
            return working.result()
        raise ClientDisconnect
    finally:
        for task in (working, leaving):
            task.cancel()
        await asyncio.gather(working, leaving, return_exceptions=True)


async def compute_while_connected(
    request: Request,
    places: asyncio.Semaphore,
    compute: Callable[[Callable[[], None]], Result],
) -> Result:
    """Compute in a thread while the client waits for it; the request's body must have been read.

    Parameters
    ----------
    request
        Request of the waiting client.
    places
        Limits the computations that run at the same time; further ones wait.
    compute
        Called with a function to call between its steps, which raises once the client has left.

    Raises
    ------
    ClientDisconnect
        When the client has left.

    """
    left = threading.Event()

    def advance() -> None:
        if left.is_set():
            raise ClientDisconnect

    try:
        return await while_connected(request, compute_in_place(places, partial(compute, advance)))
    finally:
        left.set()


async def _disconnect(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass
