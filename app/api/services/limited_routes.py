"""Limited routes: those that compute, a few at a time, so that threads are left for all others."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Coroutine
from functools import partial, wraps
from inspect import Parameter, signature
from typing import Any, TypeVar

from starlette.requests import ClientDisconnect, Request

from app.api.http.connection import while_connected
from app.api.jobs.job import compute_in_place

MOST_COMPUTATIONS = 2
"""Most explanations, previews, pages and the like computed at the same time: one takes seconds with
a large language, and threads must be left for all other requests."""

MOST_EDITS = 2
"""Most edits of languages made at the same time: one of a large language takes seconds, and is made
again if another one of that language came first."""

Made = TypeVar("Made")


class Turns:
    """Places of a server for what is done a few at a time; what finds none waits for its turn.

    Attributes
    ----------
    computations
        Computations in threads, see `computed`.
    brief_computations
        Those that never take seconds, see `computed_briefly`.
    edits
        Edits of languages, see `edited`.
    joins
        Uploads whose chapters are joined: the next one looks at what this one leaves of the disk.
    beginnings
        Resumable uploads that begin: none may come between the check of the disk and the file that
        reserves its space.

    """

    def __init__(self) -> None:
        self.computations = asyncio.Semaphore(MOST_COMPUTATIONS)
        self.brief_computations = asyncio.Semaphore(MOST_COMPUTATIONS)
        self.edits = asyncio.Semaphore(MOST_EDITS)
        self.joins, self.beginnings = asyncio.Lock(), asyncio.Lock()


def computed(route: Callable[..., Made]) -> Callable[..., Coroutine[Any, Any, Made]]:
    """Decorate a route that computes for seconds: few run at a time, while their clients wait.

    A route with the parameter ``advance`` calls it between its steps, and is ended there once its
    client has left.
    """
    return _limited(route, lambda turns: turns.computations)


def computed_briefly(route: Callable[..., Made]) -> Callable[..., Coroutine[Any, Any, Made]]:
    """Decorate a route as `computed`, whose turn does not wait for what takes seconds."""
    return _limited(route, lambda turns: turns.brief_computations)


def edited(route: Callable[..., Made]) -> Callable[..., Coroutine[Any, Any, Made]]:
    """Decorate a route that computes a change: few run at a time, and waiting takes no thread.

    It goes on when its client leaves, so that the change is in the audit log.
    """
    return _limited(route, lambda turns: turns.edits, goes_on=True)


def _limited(
    route: Callable[..., Made],
    places_of: Callable[[Turns], asyncio.Semaphore],
    *,
    goes_on: bool = False,
) -> Callable[..., Coroutine[Any, Any, Made]]:
    parameters = dict(signature(route).parameters)
    has_steps = parameters.pop("advance", None) is not None

    @wraps(route)
    async def limited(*, connection: Request, **given: Any) -> Made:
        left = threading.Event()

        def advance() -> None:
            if left.is_set():
                raise ClientDisconnect

        steps = {"advance": advance} if has_steps else {}
        places = places_of(connection.app.state.studio.turns)
        computing = compute_in_place(places, partial(route, **given, **steps))
        try:
            return await (computing if goes_on else while_connected(connection, computing))
        finally:
            left.set()

    asked = Parameter("connection", Parameter.KEYWORD_ONLY, annotation=Request)
    limited.__signature__ = signature(route).replace(  # type: ignore[attr-defined]
        parameters=[*parameters.values(), asked]
    )
    return limited
