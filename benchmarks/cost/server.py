"""Server: what a large library, many pages and long use cost it.

`library`: processor time of a page's requests to a server of 200 languages and 1000 clips, to one
of 10 and 10. `clips`: accesses to a database of 100,000 clips, to one of 1000. `watchers`: an event
for a thousand watchers and more, to a hundred, through the code that writes their streams, without
a network. `load`: how fast a server answers while pages are open and clients upload, to a server
that does nothing else. `growth`: what the same requests leave in memory; the process's resident
memory says less, since an allocator keeps free memory (`app/api/observation/heap.py`).
"""

from __future__ import annotations

import asyncio
import ctypes
import gc
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager, closing, suppress
from ctypes.util import find_library
from dataclasses import dataclass, field, replace
from datetime import timedelta
from functools import partial
from itertools import count
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any, Final

import av
import httpx
import numpy as np
from pydantic import TypeAdapter
from sqlalchemy import insert
from starlette.types import Message

from app.api.http.schemas.clips import ClipView
from app.api.routes.clips.clip_lists import read_page
from app.api.routes.events import follow_changes
from app.api.services.language_documents import draft_of
from app.api.services.running_studio import Studio, open_studio
from app.recognition import Language
from app.resources import samples_dir
from app.server import create_app
from app.settings import Settings
from app.store import Clip, ClipQuery, ClipStore, Database, Job, JobStatus, JobStore, QuotaStore
from app.store.models import now
from benchmarks.cost.robot import allocated_bytes, fit_slope
from benchmarks.cost.speed import seconds
from benchmarks.figures import Figure, Measurement, ratio, share
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.running import running

API: Final = "/api/v1"
LISTS: Final = (f"{API}/languages", f"{API}/clips")
SAMPLE: Final = samples_dir() / "osg-table-2.json"

SMALL, LARGE = (10, 10), (200, 1000)
"""Languages and clips."""

REPEATS: Final = 15
"""Runs of an action: odd for the median, which leaves out an occasional garbage collection."""

CLIPS: Final = (1000, 100_000)
AT_ONCE: Final = 10_000
"""Rows written at a time."""

CLIPS_OF_A_PAGE: Final = 500
"""As in ``static/js/core/api.js``."""

OWNERS: Final = 100
"""Addresses that the jobs come from."""

PROBED: Final = {"health": "/healthz", "page": "/", "list": f"{API}/clips"}
"""Requests that are timed, by a client that does nothing else."""

PAGES, UPLOADERS = 50, 8

SERVE: Final = """
import sys
from pathlib import Path
from app.server import run
from app.settings import Settings
data = Path(sys.argv[1])
run(Settings(data_dir=data, samples_dir=data / "none", port=0), open_browser=False)
"""


async def cost(doing: Callable[[], Awaitable[object]]) -> float:
    """Return the median processor time of `doing` in this process, in seconds."""
    spent = []
    for _ in range(REPEATS):
        before = time.process_time()
        await doing()
        spent.append(time.process_time() - before)
    return median(spent)


def fill_studio(studio: Studio, languages: int, clips: int) -> tuple[str, str]:
    """Add languages of eight gestures and finished clips; return the id of one of each."""
    sample = Language.load(SAMPLE)
    for number in range(languages):
        draft = draft_of(replace(sample, name=f"language {number}"), "Import")
        language = studio.languages.create(draft, sample.revision).record.id
    for number in range(clips):
        partial_file = studio.clips.new_partial()
        partial_file.write_bytes(b"video")
        clip = Clip(name=f"{number}.mp4", media_type="video/mp4", size=5, width=640, height=480)
        added = studio.clips.add(clip, partial_file, "benchmark")
        studio.jobs.start(added.job.id)
        studio.jobs.complete(added.job.id, 90, ())
    return language, clip.id


async def measure_page(languages: int, clips: int) -> dict[str, float]:
    """Return the cost of every action of a page on a server with so many languages and clips."""
    with TemporaryDirectory() as folder:
        app = create_app(Settings(data_dir=Path(folder), samples_dir=Path(folder) / "none"))
        async with (
            app.router.lifespan_context(app),
            httpx.AsyncClient(
                transport=httpx.ASGITransport(app), base_url="http://127.0.0.1"
            ) as client,
        ):
            language, clip = fill_studio(app.state.studio, languages, clips)
            numbers, tags = count(), dict[str, str]()

            async def open_page() -> None:
                for place in LISTS:
                    answer = (await client.get(place)).raise_for_status()
                    tags[place] = answer.headers["etag"]

            async def open_again() -> None:
                for place in LISTS:
                    answer = await client.get(place, headers={"If-None-Match": tags[place]})
                    assert answer.status_code == 304

            async def change() -> None:
                place, body = f"{API}/languages/{language}", {"name": f"renamed {next(numbers)}"}
                for each in (
                    await client.patch(place, json=body),
                    await client.get(place),
                    await client.get(f"{API}/clips/{clip}"),
                ):
                    each.raise_for_status()

            async def open_after_change() -> None:
                await change()
                await open_page()

            await open_page()
            return {
                "opened-again": await cost(open_again),
                "opened": await cost(open_page),
                "changed": await cost(change),
                "opened-after-a-change": await cost(open_after_change),
            }


def compare_libraries(quick: bool) -> Iterator[Figure]:
    """Compare a large library with a small one."""
    small, large = (
        asyncio.run(measure_page(*size)) for size in (SMALL, (20, 100) if quick else LARGE)
    )
    for name, spent in small.items():
        yield ratio(name, [large[name] / spent])


def fill(database: Database, first: int, last: int) -> None:
    """Add finished clips with these numbers."""
    clip = Clip(
        name="dive.mp4", media_type="video/mp4", size=5_000_000, width=1920, height=1080, frames=300
    ).model_dump()
    job = Job(clip_id="", client="", status=JobStatus.DONE.value, frames=300).model_dump()
    for start in range(first, last, AT_ONCE):
        numbers = range(start, min(start + AT_ONCE, last))
        moment = now()
        clips = [
            clip
            | {"id": f"{n:032x}", "job_id": f"{n:032x}", "owner": f"{n % OWNERS}"}
            | {"name": f"dive {n}.mp4", "created": moment + n * timedelta(microseconds=1)}
            for n in numbers
        ]
        jobs = [
            job
            | {"id": f"{n:032x}", "clip_id": f"{n:032x}", "created": moment}
            | {"client": f"10.0.0.{n % OWNERS}"}
            for n in numbers
        ]
        with database.writing() as session:
            session.execute(insert(Clip), clips)
            session.execute(insert(Job), jobs)


def time_accesses(database: Database, folder: Path, clips: int) -> dict[str, float]:
    """Return the processor time of each kind of access to a database of so many clips."""
    store, jobs = ClipStore(database, folder), JobStore(database, "benchmark")
    clip_id, listed = f"{clips // 2:032x}", TypeAdapter(list[ClipView])

    def add() -> None:
        partial_file = store.new_partial()
        partial_file.write_bytes(b"video")
        clip = Clip(name="new", media_type="video/mp4", size=5, width=64, height=48)
        added = store.add(clip, partial_file, "10.0.0.1")
        assert jobs.start(added.job.id) is not None
        jobs.complete(added.job.id, 1, ())
        store.delete(clip.id)

    def read(**asked: Any) -> None:
        views, _ = read_page(store, ClipQuery(CLIPS_OF_A_PAGE, **asked))
        listed.dump_json(views)

    works: dict[str, Callable[[], object]] = {
        "first-page": read,
        "later-page": partial(read, after=clip_id),
        "waiting-clips": partial(read, statuses=(JobStatus.QUEUED, JobStatus.RUNNING)),
        "search": partial(read, name="wreck"),
        "one-clip": partial(store.get, clip_id),
        "new-clip": add,
        "quota": partial(QuotaStore(database).usage, "1"),
    }
    return {name: median(seconds(work) for _ in range(5)) for name, work in works.items()}


def compare_databases(quick: bool) -> Iterator[Figure]:
    """Compare accesses to many clips with those to few, and the search with the first page."""
    found, filled = [], 0
    with (
        TemporaryDirectory() as folder,
        closing(Database(f"sqlite:///{folder}/studio.db")) as database,
    ):
        database.migrate()
        for clips in (CLIPS[0], 10 * CLIPS[0]) if quick else CLIPS:
            fill(database, filled, clips)
            filled = clips
            found.append(time_accesses(database, Path(folder) / "clips", clips))
    few, many = found
    for name, spent in few.items():
        yield ratio(name, [many[name] / spent])
    yield ratio("search-to-first-page", [many["search"] / many["first-page"]])


async def time_events(studio: Studio, watchers: int, events: int) -> float:
    """Return the processor time of sending an event to each of some watchers, in seconds."""
    received, ready = 0, 0

    async def send(message: Message) -> None:
        nonlocal received, ready
        body = message.get("body", b"")
        ready += b"listening" in body
        received += b"data:" in body

    async def receive() -> Message:
        await asyncio.Event().wait()
        raise AssertionError("a watcher stays")

    async def watch() -> None:
        stream = await follow_changes(studio)
        await stream({"type": "http", "method": "GET", "headers": []}, receive, send)

    tasks = [asyncio.create_task(watch()) for _ in range(watchers)]
    while ready < watchers:
        assert not any(each.done() for each in tasks), "a watcher left"
        await asyncio.sleep(0.01)
    before = time.process_time()
    for number in range(events):
        studio.broadcast.publish("languages", id=f"{number}")
        while received < watchers * (number + 1):
            await asyncio.sleep(0)
    spent = time.process_time() - before
    for each in tasks:
        each.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    return spent / events / watchers


async def compare_watchers(counts: tuple[int, ...]) -> dict[int, float]:
    """Return the cost of an event for each of so many watchers."""
    with TemporaryDirectory() as folder:
        settings = Settings(data_dir=Path(folder), samples_dir=Path(folder) / "none")
        async with open_studio(settings) as studio:
            return {each: await time_events(studio, each, events=5) for each in counts}


def measure_watchers(quick: bool) -> Iterator[Figure]:
    """Yield the cost of an event for each of many watchers, to each of a hundred."""
    fewest, *more = (100, 1000) if quick else (100, 1000, 10_000)
    spent = asyncio.run(compare_watchers((fewest, *more)))
    yield from (ratio(f"{each}", [spent[each] / spent[fewest]]) for each in more)


@dataclass
class Tally:
    """Times of the probed requests, in seconds, and failures of all."""

    seconds: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    requests: int = 0
    failures: int = 0

    async def send(
        self, client: httpx.AsyncClient, method: str, path: str, **given: Any
    ) -> httpx.Response | None:
        """Send a request and count it; None where it failed."""
        self.requests += 1
        with suppress(httpx.HTTPError):
            return (await client.request(method, path, **given)).raise_for_status()
        self.failures += 1
        return None


async def keep_page(address: str, tally: Tally) -> None:
    """Behave like an open page: follow the events, and ask for the lists every three seconds."""

    async def follow(client: httpx.AsyncClient) -> None:
        async with client.stream("GET", f"{API}/events", timeout=None) as stream:
            async for _ in stream.aiter_lines():
                pass

    async with httpx.AsyncClient(base_url=address, timeout=60) as client:
        following = asyncio.create_task(follow(client))
        try:
            while True:
                for path in LISTS:
                    await tally.send(client, "GET", path)
                await asyncio.sleep(3.0)
        finally:
            following.cancel()


async def upload(address: str, tally: Tally, clip: bytes) -> None:
    """Behave like a client that adds clips, and deletes each when its poses are found."""
    async with httpx.AsyncClient(base_url=address, timeout=120) as client:
        while True:
            files = {"file": ("dive.mkv", clip)}
            added = await tally.send(client, "POST", f"{API}/clips", files=files)
            if added is None:
                await asyncio.sleep(1)
                continue
            job = f"{API}/jobs/{added.json()['job_id']}"
            while (answer := await tally.send(client, "GET", job)) is not None:
                if answer.json()["status"] in ("done", "failed", "cancelled"):
                    break
                await asyncio.sleep(0.5)
            await tally.send(client, "DELETE", f"{API}/clips/{added.json()['id']}")


async def probe(address: str, duration: float, tally: Tally) -> None:
    """Time each kind of request again and again."""
    async with httpx.AsyncClient(base_url=address, timeout=60) as client:
        end = time.monotonic() + duration
        while time.monotonic() < end:
            for name, path in PROBED.items():
                began = time.perf_counter()
                await tally.send(client, "GET", path)
                tally.seconds[name].append(time.perf_counter() - began)
                await asyncio.sleep(0.02)


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


@asynccontextmanager
async def serving(folder: Path) -> AsyncIterator[str]:
    """Run a server in a process of its own; yield its address."""
    command = [sys.executable, "-c", SERVE, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            line = await asyncio.to_thread(process.stdout.readline)
            yield next(word for word in line.split() if word.startswith("http://"))
        finally:
            process.terminate()


async def load(duration: float) -> tuple[Tally, Tally]:
    """Probe an idle server, then one with open pages and uploading clients; return both."""
    idle, loaded = Tally(), Tally()
    with TemporaryDirectory() as folder:
        clip = small_clip(Path(folder) / "dive.mkv")
        async with serving(Path(folder) / "data") as address:
            await probe(address, duration / 4, idle)
            tasks = [asyncio.create_task(keep_page(address, loaded)) for _ in range(PAGES)]
            tasks += [asyncio.create_task(upload(address, loaded, clip)) for _ in range(UPLOADERS)]
            await asyncio.sleep(3)  # until all are connected
            await probe(address, duration, loaded)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
    return idle, loaded


def measure_load(quick: bool) -> Iterator[Figure]:
    """Yield how long requests take under load, to the median of an idle server, and failures."""
    idle, loaded = asyncio.run(load(10.0 if quick else 60.0))
    for name, taken in loaded.seconds.items():
        alone = median(idle.seconds[name])
        for part, percent in (("half", 50), ("slowest", 99)):
            slow = float(np.percentile(taken, percent)) / alone
            yield Figure(f"{name}/{part}", slow, len(taken), unit="ratio")
    yield share("failed", loaded.failures, loaded.requests)


def send_cycle(client: httpx.Client, studio: Studio, clip: str, language: str) -> None:
    """Send requests that leave nothing; only the recognitions stay, in the database."""
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


def measure_growth(quick: bool) -> Iterator[Figure]:
    """Yield the growth of Python's blocks, of the heap of C and of SQLite, in a hundred cycles."""
    found: dict[str, list[float]] = defaultdict(list)
    sqlite_bytes = ctypes.CDLL(find_library("sqlite3")).sqlite3_memory_used
    sqlite_bytes.restype = ctypes.c_int64
    cycles = 5 if quick else 20
    with TemporaryDirectory() as folder:
        settings = Settings(data_dir=Path(folder) / "data", samples_dir=Path(folder) / "none")
        with (
            running(settings) as server,
            httpx.Client(base_url=server.address, timeout=120) as client,
        ):
            clip = add_recorded_clip(server.studio, recording_of("circle"))
            made = client.post(f"{API}/languages/import", content=SAMPLE.read_bytes())
            for _ in range(4 if quick else 8):
                for _ in range(cycles):
                    send_cycle(client, server.studio, clip, made.json()["id"])
                gc.collect()
                found["blocks"].append(sys.getallocatedblocks())
                found["heap-kB"].append(allocated_bytes() / 1e3)
                found["sqlite-kB"].append(sqlite_bytes() / 1e3)
    for name, values in found.items():
        yield fit_slope(name, values[2:], cycles / 100)
    yield Figure("share-of-blocks", found["blocks"][-1] / found["blocks"][2] - 1, 1, unit="%")


def measurements(folder: Path, methods: tuple[str, ...]) -> Iterator[Measurement]:
    """Yield what each burden costs a server."""
    for name, run, protocol in (
        ("library", compare_libraries, "requests at 200 languages and 1000 clips, to 10 and 10"),
        ("clips", compare_databases, "accesses to SQLite with 100,000 clips, to 1000"),
        ("watchers", measure_watchers, "an event for each of 1000 or 10,000 watchers, to of 100"),
        ("load", measure_load, "requests beside 50 pages and 8 uploading clients, to none"),
        ("growth", measure_growth, "what is kept after 100 cycles of 19 requests"),
    ):
        alone = name != "growth"
        yield Measurement(f"server/{name}", run, "none", protocol, measures=("app",), alone=alone)
