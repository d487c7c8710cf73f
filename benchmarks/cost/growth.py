"""Growth: what a server keeps in memory after the same requests, again and again.

``python -m benchmarks.cost.growth`` runs a server in this process and sends it cycles of requests
that leave nothing behind: recognitions, checks, a clip and a language that are added and deleted.
At intervals it prints how many blocks Python has allocated, the bytes allocated in the heap of C,
and SQLite's memory. The process's resident memory says less: an allocator keeps free memory (see
`benchmarks.soak`).
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import sys
import tempfile
from ctypes.util import find_library
from pathlib import Path
from typing import Final

import httpx

from app.api.services.running_studio import Studio
from app.resources import samples_dir
from app.settings import Settings
from benchmarks.cost.endurance import allocated_bytes
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import running

API: Final = "/api/v1"


def work(client: httpx.Client, studio: Studio, clip: str, language: str) -> None:
    """Send a cycle of requests; only the recognitions stay, in the database."""
    for _ in range(3):
        body = {"clip_id": clip, "language_id": language}
        client.post(f"{API}/recognitions", json=body).raise_for_status()
        client.get("/metrics").raise_for_status()
        client.get(f"{API}/languages/{language}/check").raise_for_status()
    for part in ("", "/video", "/poses", "/takes"):
        client.get(f"{API}/clips/{clip}{part}").raise_for_status()
    added = add_recorded_clip(studio, recording_of("circle"))
    client.delete(f"{API}/clips/{added}").raise_for_status()
    made = client.post(f"{API}/languages", json={"name": "pool"}).raise_for_status().json()
    place = f"{API}/languages/{made['id']}"
    for number in range(3):
        client.patch(place, json={"name": f"pool {number}"}).raise_for_status()
    client.delete(place).raise_for_status()


def sqlite_bytes() -> int:
    """Return what SQLite has allocated in this process."""
    used = ctypes.CDLL(find_library("sqlite3")).sqlite3_memory_used
    used.restype = ctypes.c_int64
    return int(used())


def main() -> None:
    """Send the cycles and print the memory that is kept."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--cycles", type=int, default=25, help="between two lines")
    parser.add_argument("--lines", type=int, default=9)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        settings = Settings(data_dir=Path(folder) / "data", samples_dir=Path(folder) / "none")
        with (
            running(settings) as server,
            httpx.Client(base_url=server.address, timeout=120) as client,
        ):
            clip = add_recorded_clip(server.studio, recording_of("circle"))
            content = (samples_dir() / "osg-table-2.json").read_bytes()
            made = client.post(f"{API}/languages/import", content=content).raise_for_status()
            for line in range(1, given.lines + 1):
                for _ in range(given.cycles):
                    work(client, server.studio, clip, made.json()["id"])
                gc.collect()
                print(
                    f"{line * given.cycles:5d} cycles: {sys.getallocatedblocks():,d} blocks of "
                    f"Python, {allocated_bytes() / 1e6:.2f} MB of the heap of C, "
                    f"{sqlite_bytes() / 1e6:.2f} MB of SQLite",
                    flush=True,
                )


if __name__ == "__main__":
    main()
