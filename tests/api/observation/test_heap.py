"""The heap of a long-running server returns freed memory."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from app.api.observation import heap

MEBIBYTE = 1024 * 1024


def resident() -> int:
    """Return the resident bytes of this process."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(heap._find("malloc_trim") is None, reason="needs glibc")
def test_what_lies_free_between_what_is_in_use_is_given_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(heap, "TRIM_SECONDS", 0.01)
    blocks = [bytes([number % 256]) * 50_000 for number in range(2000)]  # written, so resident
    kept = blocks[::50]
    del blocks
    before = resident()

    async def wait() -> None:
        async with asyncio.timeout(60):
            trimming = asyncio.create_task(heap.keep_trimmed())
            while before - resident() < 50 * MEBIBYTE:
                await asyncio.sleep(0.01)
            trimming.cancel()
            with suppress(asyncio.CancelledError):
                await trimming

    asyncio.run(wait())
    assert len(kept) == 40


ALLOCATE = """
import ctypes, sys, threading
from app.api.observation import heap
if sys.argv[1] == "shared":
    heap.share_arenas()
barrier = threading.Barrier(12)
def work():
    kept = [bytes(1000) for _ in range(100)]
    barrier.wait()
    barrier.wait()
threads = [threading.Thread(target=work) for _ in range(11)]
for thread in threads:
    thread.start()
barrier.wait()
# Every arena but the first is a mapping of its own, 64 MiB at a multiple of 64 MiB; what it does
# not use yet cannot be read. Other mappings may begin at such a place by chance.
with open("/proc/self/maps") as maps:
    words = [line.split()[:2] for line in maps]
found = [([int(end, 16) for end in place.split("-")], access) for place, access in words]
print(sum(
    start % 2**26 == 0 and access == "rw-p" and rest == "---p" and end == after
    and last >= start + 2**26
    for ((start, end), access), ((after, last), rest) in zip(found, found[1:])
))
barrier.wait()
"""


@pytest.mark.skipif(heap._find("mallopt") is None, reason="needs glibc")
def test_threads_share_arenas() -> None:
    found = {
        how: int(subprocess.check_output([sys.executable, "-c", ALLOCATE, how]))
        for how in ("own", "shared")
    }
    assert found["shared"] < heap.ARENAS < found["own"]


def test_another_c_library_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.platform", "win32")
    heap.share_arenas()
    asyncio.run(heap.keep_trimmed())
