"""Load: 50 open pages and 8 uploading clients on one server, and how fast it answers meanwhile.

``python -m benchmarks.cost.load`` starts a server of its own on an empty folder and prints the 50th
and 99th percentile of the page, the API and the health check, the failed requests, and the server's
share of a core. Each page follows the event stream and asks for both lists every three seconds;
each uploading client sends a small clip, waits for its poses, deletes it and begins again.
"""

from __future__ import annotations

import argparse
import asyncio
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Final

import av
import httpx
import numpy as np

PROBED: Final = {"health": "/healthz", "page": "/", "API": "/api/v1/clips"}
"""Requests that are timed, by a client that does nothing else."""

LIST_SECONDS: Final = 3.0
"""Seconds between a page's requests for its lists."""

PROBE_SECONDS: Final = 0.05
"""Seconds between two timed requests."""

SERVE: Final = """
import sys
from pathlib import Path
from app.server import run
from app.settings import Settings
data = Path(sys.argv[1])
run(Settings(data_dir=data, samples_dir=data / "none", port=0), open_browser=False)
"""


class Tally:
    """Times of the probed requests, and failures of all."""

    def __init__(self) -> None:
        self.seconds: dict[str, list[float]] = defaultdict(list)
        self.requests = 0
        self.failures: list[str] = []
        self.events = 0
        self.uploads = 0

    async def send(
        self, client: httpx.AsyncClient, method: str, path: str, **given: object
    ) -> httpx.Response | None:
        """Send a request and count it; None where it failed."""
        self.requests += 1
        try:
            answer = await client.request(method, path, **given)  # type: ignore[arg-type]
        except httpx.HTTPError as error:
            self.failures.append(f"{method} {path}: {type(error).__name__}")
            return None
        if answer.status_code >= 400:
            self.failures.append(f"{method} {path}: {answer.status_code}")
            return None
        return answer


async def watch(address: str, tally: Tally) -> None:
    """Behave like an open page."""

    async def follow(client: httpx.AsyncClient) -> None:
        async with client.stream("GET", "/api/v1/events", timeout=None) as stream:
            async for line in stream.aiter_lines():
                tally.events += line.startswith("data:")

    async with httpx.AsyncClient(base_url=address, timeout=60) as client:
        following = asyncio.create_task(follow(client))
        try:
            while True:
                for path in ("/api/v1/clips", "/api/v1/languages"):
                    await tally.send(client, "GET", path)
                await asyncio.sleep(LIST_SECONDS)
        finally:
            following.cancel()


async def upload(address: str, clip: bytes, tally: Tally) -> None:
    """Behave like a client that adds clips."""
    async with httpx.AsyncClient(base_url=address, timeout=120) as client:
        while True:
            files = {"file": ("dive.mkv", clip)}
            added = await tally.send(client, "POST", "/api/v1/clips", files=files)
            if added is None:
                await asyncio.sleep(1)
                continue
            tally.uploads += 1
            job = f"/api/v1/jobs/{added.json()['job_id']}"
            while (answer := await tally.send(client, "GET", job)) is not None:
                if answer.json()["status"] in ("done", "failed", "cancelled"):
                    break
                await asyncio.sleep(0.5)
            await tally.send(client, "DELETE", f"/api/v1/clips/{added.json()['id']}")


async def probe(address: str, path: str, seconds: list[float], tally: Tally) -> None:
    """Time one kind of request again and again."""
    async with httpx.AsyncClient(base_url=address, timeout=60) as client:
        while True:
            began = time.perf_counter()
            await tally.send(client, "GET", path)
            seconds.append(time.perf_counter() - began)
            await asyncio.sleep(PROBE_SECONDS)


def small_clip(path: Path, frames: int = 30) -> bytes:
    """Return a clip of noise, without a person."""
    random = np.random.default_rng(1)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=25)
        stream.width, stream.height = 320, 240
        for _ in range(frames):
            image = random.integers(0, 255, (240, 320, 3), np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, "rgb24")))
        container.mux(stream.encode())
    return path.read_bytes()


def cpu_seconds(pid: int) -> float:
    """Return the processor time of a process alone, without its workers."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / 100


@asynccontextmanager
async def serving(folder: Path) -> AsyncIterator[tuple[str, int]]:
    """Run a server in a process of its own; yield its address and process id."""
    command = [sys.executable, "-c", SERVE, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            line = await asyncio.to_thread(process.stdout.readline)
            yield next(word for word in line.split() if word.startswith("http://")), process.pid
        finally:
            process.terminate()


async def measure(watchers: int, uploaders: int, seconds: float) -> Tally:
    """Load a server for some seconds, and return the counts."""
    tally = Tally()
    with tempfile.TemporaryDirectory() as folder:
        clip = small_clip(Path(folder) / "dive.mkv")
        async with serving(Path(folder) / "data") as (address, pid):
            tasks = [asyncio.create_task(watch(address, tally)) for _ in range(watchers)]
            tasks += [asyncio.create_task(upload(address, clip, tally)) for _ in range(uploaders)]
            await asyncio.sleep(3)  # until all are connected
            began, before = time.monotonic(), cpu_seconds(pid)
            tasks += [
                asyncio.create_task(probe(address, path, tally.seconds[name], tally))
                for name, path in PROBED.items()
            ]
            await asyncio.sleep(seconds)
            share = (cpu_seconds(pid) - before) / (time.monotonic() - began)
            for task in tasks:
                task.cancel()
            with suppress(asyncio.CancelledError):
                await asyncio.gather(*tasks, return_exceptions=True)
    print(
        f"{watchers} pages, {uploaders} uploading clients, {seconds:g} s: {tally.requests} "
        f"requests, {tally.uploads} clips, {tally.events} events, {share:.2f} of a core"
    )
    return tally


def main() -> None:
    """Run the load and print the figures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--watchers", type=int, default=50, help="open pages")
    parser.add_argument("--uploaders", type=int, default=8, help="clients that upload clips")
    parser.add_argument("--seconds", type=float, default=60.0)
    given = parser.parse_args()
    tally = asyncio.run(measure(given.watchers, given.uploaders, given.seconds))
    for name, seconds in tally.seconds.items():
        p50, p99 = np.percentile(np.array(seconds) * 1000, [50, 99])
        print(f"{name:<8} p50 {p50:6.0f} ms   p99 {p99:6.0f} ms   ({len(seconds)} requests)")
    print(f"failed   {len(tally.failures)} {sorted(set(tally.failures))[:5] or ''}")


if __name__ == "__main__":
    main()
