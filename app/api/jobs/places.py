"""Places: limit the computations in threads that run at the same time."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import TypeVar

from starlette.concurrency import run_in_threadpool

Result = TypeVar("Result")


async def compute_in_place(places: asyncio.Semaphore, compute: Callable[[], Result]) -> Result:
    """Compute in a thread, which keeps its place until it ends, even if the caller is cancelled.

    A thread cannot be interrupted. Were its place free at once, any number of threads would compute
    for clients who have left.
    """
    await places.acquire()
    computing = asyncio.create_task(run_in_threadpool(compute))

    def leave(ended: asyncio.Task[Result]) -> None:
        places.release()
        if not ended.cancelled():
            ended.exception()  # perhaps nobody else asks for it

    computing.add_done_callback(leave)
    await asyncio.wait([computing])
    return computing.result()
