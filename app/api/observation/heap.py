"""Heap of the server process: gives what was freed back to the system."""

from __future__ import annotations

import asyncio
import ctypes
import sys
from collections.abc import Callable

TRIM_SECONDS = 60.0
"""Between two trims. One takes milliseconds, and the heap grows by a megabyte a minute at most."""


async def keep_trimmed() -> None:
    """Trim the heap from time to time until cancelled; return at once where that is not possible.

    glibc keeps freed memory between what is in use, in an arena for each thread that ever waited
    for another: under steady use resident memory grows by some 50 MB an hour while what is in use
    stays the same (`python -m benchmarks.soak`).
    """
    trim = _find_trim()
    while trim is not None:
        await asyncio.sleep(TRIM_SECONDS)
        await asyncio.to_thread(trim, 0)


def _find_trim() -> Callable[[int], object] | None:
    """Return glibc's `malloc_trim`; None where the C library is another one."""
    if sys.platform != "linux":
        return None
    return getattr(ctypes.CDLL(None), "malloc_trim", None)
