"""Heap of the server process: returns freed memory to the system."""

from __future__ import annotations

import asyncio
import ctypes
import sys
from collections.abc import Callable

TRIM_SECONDS = 60.0
"""Seconds between two trims; one takes milliseconds, and the heap grows by at most 1 MB a
minute."""


ARENAS = 2
"""Number of heap arenas for all threads. glibc makes eight a core, each with its own free memory;
Python's threads compute one at a time, so they seldom wait for an arena."""

_M_ARENA_MAX = -8
"""Number of that option in glibc's ``malloc.h``."""


def share_arenas() -> None:
    """Limit the heap to a few arenas for all threads; call it before threads are started."""
    if (limit := _find("mallopt")) is not None:
        limit(_M_ARENA_MAX, ARENAS)


async def keep_trimmed() -> None:
    """Trim the heap from time to time until cancelled; return at once if that is not possible.

    glibc keeps freed memory between used blocks, in one arena for each thread that ever waited for
    another: under steady load resident memory grows while used memory stays the same
    (`benchmarks/studies/server.md`).
    """
    trim = _find("malloc_trim")
    while trim is not None:
        await asyncio.sleep(TRIM_SECONDS)
        await asyncio.to_thread(trim, 0)


def _find(name: str) -> Callable[..., object] | None:
    """Return a function of glibc; None with another C library."""
    if sys.platform != "linux":
        return None
    library = ctypes.CDLL(None)
    return getattr(library, name) if hasattr(library, "gnu_get_libc_version") else None
