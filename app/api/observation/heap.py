"""Heap of the server process: returns freed memory to the system."""

from __future__ import annotations

import asyncio
import ctypes
import sys
from collections.abc import Callable

TRIM_SECONDS = 60.0
"""Between two trims. One takes milliseconds, and the heap grows by a megabyte a minute at most."""


ARENAS = 2
"""Arenas of the heap for all threads. glibc makes eight a core, each of which keeps free memory of
its own; Python's threads compute one at a time, so that they seldom wait for an arena."""

_M_ARENA_MAX = -8
"""Number of that option in glibc's ``malloc.h``."""


def share_arenas() -> None:
    """Have all threads share a few arenas; call it before there are threads."""
    if (limit := _find("mallopt")) is not None:
        limit(_M_ARENA_MAX, ARENAS)


async def keep_trimmed() -> None:
    """Trim the heap from time to time until cancelled; return at once where that is not possible.

    glibc keeps freed memory between what is in use, in an arena for each thread that ever waited
    for another: under steady use resident memory grows while what is in use stays the same
    (`python -m benchmarks.soak`, `docs/reliability.md`).
    """
    trim = _find("malloc_trim")
    while trim is not None:
        await asyncio.sleep(TRIM_SECONDS)
        await asyncio.to_thread(trim, 0)


def _find(name: str) -> Callable[..., object] | None:
    """Return a function of glibc; None where the C library is another one."""
    if sys.platform != "linux":
        return None
    library = ctypes.CDLL(None)
    return getattr(library, name) if hasattr(library, "gnu_get_libc_version") else None
