"""Persistence: repeats the write of a job's state until the database accepts it."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from starlette.concurrency import run_in_threadpool

from app.store import StoreUnavailable

FIRST_PAUSE_SECONDS = 0.5
LONGEST_PAUSE_SECONDS = 5.0
"""Longest pause between attempts: short enough that nobody waits long once the database is back."""

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

logger = logging.getLogger(__name__)


async def persist(
    call: Callable[Arguments, Result], *args: Arguments.args, **kwargs: Arguments.kwargs
) -> Result:
    """Call a method of the store in a thread, and repeat it while the database is locked or full.

    A job whose end is not stored would seem to run for ever. Cancelling the task ends the attempts.
    """
    pause = FIRST_PAUSE_SECONDS
    while True:
        try:
            return await run_in_threadpool(call, *args, **kwargs)
        except StoreUnavailable as error:
            if pause == FIRST_PAUSE_SECONDS:
                logger.warning("a job's state cannot be stored yet: %s", error)
            await asyncio.sleep(pause)
            pause = min(2 * pause, LONGEST_PAUSE_SECONDS)
