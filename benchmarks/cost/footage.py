"""Footage: how much faster two processes find the landmarks of a folder than one.

Both read the same clips, in turn, each time into an empty folder; the median of the ratios is
reported, with how many cores one process keeps busy, since more than one leaves less to gain.
"""

from __future__ import annotations

import asyncio
import os
import tempfile
from pathlib import Path
from statistics import median
from time import perf_counter

from app.api.workers.footage import Footage
from app.api.workers.worker_processes import Workers
from app.resources import samples_dir
from app.settings import Settings

ROUNDS = 3
CLIPS = 6


def measure(clips: list[Path], count: int) -> tuple[float, float]:
    """Extract clips by `count` processes; return the elapsed and the processor seconds."""
    with tempfile.TemporaryDirectory() as folder:
        workers = Workers(Settings(data_dir=Path(folder)))
        footage = Footage(clips, Path(folder) / "recordings", workers, lambda progress: None)
        before, began = os.times(), perf_counter()
        ended = asyncio.run(footage.extract(count))
        seconds, after = perf_counter() - began, os.times()
    assert all(each.new for each in ended), "every clip is read every time"
    spent = after.children_user + after.children_system
    return seconds, spent - before.children_user - before.children_system


def main() -> None:
    """Print the ratio for some sample clips."""
    clips = sorted((samples_dir() / "clips").glob("*-test-1.mp4"))[:CLIPS]
    ratios, cores = [], []
    for _ in range(ROUNDS):
        one, spent = measure(clips, 1)
        two, _ = measure(clips, 2)
        ratios.append(one / two)
        cores.append(spent / one)
    print(
        f"extract: two processes are {median(ratios):.2f} times as fast as one "
        f"({min(ratios):.2f} to {max(ratios):.2f}, {ROUNDS} pairs, {len(clips)} clips, "
        f"{os.cpu_count()} cores at a load of {os.getloadavg()[0]:.1f}); "
        f"one keeps {median(cores):.2f} cores busy"
    )


if __name__ == "__main__":
    main()
