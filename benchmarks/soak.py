"""Soak: a server under light, steady use for long, and whether its memory stays flat.

``python -m benchmarks.soak --minutes 60`` starts a server of its own and uses it: event watchers
that come and go, uploads with their extraction, recognitions, previews, edits and deletions. Every
few seconds it reads the server's resident memory, file descriptors, threads and child processes.
After a warm-up it fits a line by least squares and prints its slope with a 95 % interval, which
allows for the correlation of neighbouring samples. The exit code is 1 if the memory grows, that is,
if the whole interval is above a megabyte in ten minutes, or if descriptors are left open at the
end.
"""

from __future__ import annotations

import argparse
import asyncio
import random
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import httpx
import numpy as np
import numpy.typing as npt

from app.resources import samples_dir
from benchmarks.cost.load import Tally, serving, small_clip
from benchmarks.crash import workers_of

API: Final = "/api/v1"
SAMPLE_SECONDS: Final = 2.0
WARM_SHARE: Final = 0.25
"""Share of the time used as warm-up: caches fill, and the allocator reaches its size."""

MOST_GROWTH: Final = 6.0
"""Megabytes an hour that may be measurement: a leak of a kilobyte a request is ten times that."""

CLOSED_BETWEEN: Final = ("RemoteProtocolError", "ReadError")
"""Errors of a request on a connection that the server closed as idle at the same moment; clients
repeat it, and it is counted separately."""

PAUSE_SECONDS: Final = 0.5
"""Seconds between two requests of a client: light use, so that other programs can work."""


@dataclass
class Samples:
    """Measurements of the server.

    Attributes
    ----------
    seconds
        Since the beginning.
    megabytes
        Resident memory.
    descriptors, threads, children
        Open files, threads and worker processes.

    """

    seconds: list[float] = field(default_factory=list)
    megabytes: list[float] = field(default_factory=list)
    descriptors: list[int] = field(default_factory=list)
    threads: list[int] = field(default_factory=list)
    children: list[int] = field(default_factory=list)

    def read(self, pid: int, seconds: float) -> None:
        """Add one sample."""
        status = dict(
            line.split(":", 1) for line in Path(f"/proc/{pid}/status").read_text().splitlines()
        )
        self.seconds.append(seconds)
        self.megabytes.append(int(status["VmRSS"].split()[0]) / 1024)
        self.threads.append(int(status["Threads"]))
        self.descriptors.append(sum(1 for _ in Path(f"/proc/{pid}/fd").iterdir()))
        self.children.append(len(workers_of(pid)))


def fit_slope(
    seconds: npt.NDArray[np.float64], values: npt.NDArray[np.float64]
) -> tuple[float, float]:
    """Fit a line; return its slope an hour and half of its 95 % interval.

    With a correlation r of successive residuals, N samples count as N (1 - r) / (1 + r).
    """
    hours = seconds / 3600
    centred = hours - hours.mean()
    spread = float((centred**2).sum())
    slope = float((centred * (values - values.mean())).sum() / spread)
    residuals = values - values.mean() - slope * centred
    variance = float((residuals**2).sum()) / max(len(values) - 2, 1)
    if variance == 0:
        return slope, 0.0
    correlation = float((residuals[1:] * residuals[:-1]).sum() / (residuals**2).sum())
    correlation = min(max(correlation, 0.0), 0.99)
    independent = (1 - correlation) / (1 + correlation)
    return slope, 1.96 * float(np.sqrt(variance / spread / independent))


async def watch(address: str, tally: Tally, draw: random.Random) -> None:
    """Follow the events for some seconds, leave, and come back."""
    while True:
        with suppress(TimeoutError, httpx.HTTPError):
            async with (
                asyncio.timeout(draw.uniform(2, 20)),
                httpx.AsyncClient(base_url=address) as client,
                client.stream("GET", f"{API}/events", timeout=None) as stream,
            ):
                async for line in stream.aiter_lines():
                    tally.events += line.startswith("data:")
        await asyncio.sleep(PAUSE_SECONDS)


async def add_clips(address: str, tally: Tally, clip: bytes) -> None:
    """Upload a clip, wait for its job, read all its data, and delete it."""
    async with httpx.AsyncClient(base_url=address, timeout=120) as client:
        while True:
            added = await tally.send(
                client, "POST", f"{API}/clips", files={"file": ("dive.mkv", clip)}
            )
            if added is not None:
                tally.uploads += 1
                ids = added.json()
                while (
                    job := await tally.send(client, "GET", f"{API}/jobs/{ids['job_id']}")
                ) is not None and job.json()["status"] in ("queued", "running"):
                    await asyncio.sleep(PAUSE_SECONDS)
                for part in ("", "/video", "/poses", "/takes"):
                    await tally.send(client, "GET", f"{API}/clips/{ids['id']}{part}")
                await tally.send(client, "DELETE", f"{API}/clips/{ids['id']}")
            await asyncio.sleep(4 * PAUSE_SECONDS)


async def recognise(address: str, tally: Tally, clip: str, language: str) -> None:
    """Recognise a take again and again, and ask why."""
    async with httpx.AsyncClient(base_url=address, timeout=120) as client:
        while True:
            body = {"clip_id": clip, "language_id": language}
            await tally.send(client, "POST", f"{API}/recognitions", json=body)
            await tally.send(client, "GET", f"{API}/languages/{language}/check")
            await tally.send(client, "GET", "/metrics")
            await asyncio.sleep(PAUSE_SECONDS)


async def edit(address: str, tally: Tally, draw: random.Random) -> None:
    """Create a language, change it, and delete it."""
    async with httpx.AsyncClient(base_url=address, timeout=120) as client:
        file = min(samples_dir().glob("*.json"), key=lambda path: path.stat().st_size)
        while True:
            made = await tally.send(
                client, "POST", f"{API}/languages/import", content=file.read_bytes()
            )
            if made is not None:
                place = f"{API}/languages/{made.json()['id']}"
                for _ in range(3):
                    name = {"name": f"language {draw.random()}"}
                    await tally.send(client, "PATCH", place, json=name)
                label = made.json()["gestures"][0]["label"]
                body = {"label": label, "change": {}}
                await tally.send(client, "POST", f"{place}/preview", json=body)
                await tally.send(client, "DELETE", place)
            await asyncio.sleep(4 * PAUSE_SECONDS)


async def prepare(address: str) -> tuple[str, str]:
    """Add a clip with a take, and a language; return their ids."""
    async with httpx.AsyncClient(base_url=address, timeout=300) as client:
        clip = samples_dir() / "clips" / "line-test-1.mp4"
        files = {"file": (clip.name, clip.read_bytes())}
        added = (await client.post(f"{API}/clips", files=files)).raise_for_status().json()
        while True:
            job = (await client.get(f"{API}/jobs/{added['job_id']}")).json()
            if job["status"] not in ("queued", "running"):
                break
            await asyncio.sleep(1)
        content = (samples_dir() / "osg-table-2.json").read_bytes()
        made = await client.post(f"{API}/languages/import", content=content)
        return added["id"], made.raise_for_status().json()["id"]


async def soak(minutes: float, every: int, seed: int) -> tuple[Samples, Tally]:
    """Use a server for some time, and print a line every few samples."""
    samples, tally, draw = Samples(), Tally(), random.Random(seed)
    with tempfile.TemporaryDirectory() as folder:
        clip = small_clip(Path(folder) / "dive.mkv", frames=10)
        async with serving(Path(folder) / "data") as (address, pid):
            recorded, language = await prepare(address)
            samples.read(pid, 0.0)
            idle = samples.descriptors[0]
            tasks = [
                asyncio.create_task(work)
                for work in (
                    *(watch(address, tally, random.Random(seed + each)) for each in range(10)),
                    add_clips(address, tally, clip),
                    recognise(address, tally, recorded, language),
                    edit(address, tally, draw),
                )
            ]
            began = time.monotonic()
            while (seconds := time.monotonic() - began) < 60 * minutes:
                await asyncio.sleep(SAMPLE_SECONDS)
                samples.read(pid, seconds)
                if len(samples.seconds) % every == 0:
                    print(
                        f"{seconds / 60:6.1f} min {samples.megabytes[-1]:7.1f} MB "
                        f"{samples.descriptors[-1]:4d} files {samples.threads[-1]:3d} threads "
                        f"{tally.requests} requests",
                        flush=True,
                    )
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            for _ in range(20):  # idle connections are closed within seconds
                await asyncio.sleep(SAMPLE_SECONDS)
                samples.read(pid, time.monotonic() - began)
                if samples.descriptors[-1] <= idle:
                    break
    return samples, tally


def main() -> None:
    """Run the soak and print what it found."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--every", type=int, default=30, help="samples between two lines")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    samples, tally = asyncio.run(soak(given.minutes, given.every, given.seed))
    seconds, megabytes = np.array(samples.seconds), np.array(samples.megabytes)
    warm = (seconds > WARM_SHARE * 60 * given.minutes) & (seconds < 60 * given.minutes)
    closed = [each for each in tally.failures if each.endswith(CLOSED_BETWEEN)]
    failed = [each for each in tally.failures if each not in closed]
    slope, half = fit_slope(seconds[warm], megabytes[warm])
    files, more = fit_slope(seconds[warm], np.array(samples.descriptors, dtype=float)[warm])
    # Not compared with the beginning: the pool of database connections has filled since.
    left = samples.descriptors[-1] - min(np.array(samples.descriptors)[warm].tolist())
    print(
        f"{given.minutes:g} minutes, {tally.requests} requests, {tally.uploads} clips, "
        f"{tally.events} events, {len(failed)} failed {sorted(set(failed))[:3]}, "
        f"{len(closed)} on connections that were closed as idle\n"
        f"memory {megabytes[warm][0]:.1f} MB after warming up, {megabytes[warm][-1]:.1f} MB at the "
        f"end, at most {megabytes.max():.1f} MB\n"
        f"slope {slope:+.1f} MB an hour (95 % {slope - half:+.1f} to {slope + half:+.1f})\n"
        f"open files {files:+.1f} an hour (95 % {files - more:+.1f} to {files + more:+.1f}), "
        f"{left:+d} at the end against the fewest; "
        f"threads {min(samples.threads)} to {max(samples.threads)}"
    )
    sys.exit(slope - half > MOST_GROWTH or left > 2 or bool(failed))


if __name__ == "__main__":
    main()
