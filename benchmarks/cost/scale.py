"""Scale: what a library of a million clips and thousands of watchers cost one server.

``python -m benchmarks.cost.scale`` fills a database of its own with a given number of clips, and
measures the accesses that grow with it: the whole list, pages of it and searches as the studio's
page requests them, one clip, a new job and its start, a quota, and the search for jobs left by
other servers. With ``--database URL`` it uses an empty PostgreSQL. Then it sends events to
watchers, through the code that writes their streams, without a network.
"""

from __future__ import annotations

import argparse
import asyncio
import tempfile
import time
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path
from statistics import median
from typing import Any

from pydantic import TypeAdapter
from sqlalchemy import insert
from starlette.types import Message

from app.api.http.schemas.clips import ClipView
from app.api.routes.clips.clip_lists import read_page
from app.api.routes.events import follow_changes
from app.api.services.running_studio import open_studio
from app.settings import Settings
from app.store import Clip, ClipQuery, ClipStore, Database, Job, JobStatus, JobStore, QuotaStore
from app.store.models import now

AT_ONCE = 10_000
"""Rows written at a time."""

REPEATS = 5

CLIPS_OF_A_PAGE = 500
"""As in ``static/js/core/api.js``."""

OPEN = (JobStatus.QUEUED, JobStatus.RUNNING)

LISTED = TypeAdapter(list[ClipView])

CLIENTS = 100
"""Addresses that the jobs come from."""


def fill(database: Database, first: int, last: int) -> None:
    """Add finished clips with these numbers."""
    clip = Clip(
        name="dive.mp4", media_type="video/mp4", size=5_000_000, width=1920, height=1080, frames=300
    ).model_dump()
    job = Job(clip_id="", client="", status=JobStatus.DONE.value, frames=300).model_dump()
    for start in range(first, last, AT_ONCE):
        numbers = range(start, min(start + AT_ONCE, last))
        with database.writing() as session:
            moment = {"created": now()}
            session.execute(
                insert(Clip),
                [
                    {**clip, "id": f"{n:032x}", "job_id": f"{n:032x}", "owner": f"{n % CLIENTS}"}
                    | {
                        "name": f"dive {n}.mp4",
                        "created": moment["created"] + n * timedelta(microseconds=1),
                    }
                    for n in numbers
                ],
            )
            session.execute(
                insert(Job),
                [
                    {**job, **moment, "id": f"{n:032x}", "clip_id": f"{n:032x}"}
                    | {"client": f"10.0.0.{n % CLIENTS}"}
                    for n in numbers
                ],
            )


def milliseconds(work: Callable[[], object], repeats: int = REPEATS) -> str:
    """Return the median elapsed time of some work, and this process's processor time for it."""
    taken, spent = [], []
    for _ in range(repeats):
        began, before = time.perf_counter(), time.process_time()
        work()
        taken.append(1000 * (time.perf_counter() - began))
        spent.append(1000 * (time.process_time() - before))
    return f"{median(taken):.1f} ms, {median(spent):.1f} ms of a core"


def measure_rows(database: Database, folder: Path, clips: int, longest_list: int) -> None:
    """Print the time of each kind of access to a database of so many clips."""
    store, jobs = ClipStore(database, folder), JobStore(database, "benchmark")
    clip_id = f"{clips // 2:032x}"

    def add() -> None:
        partial = store.new_partial()
        partial.write_bytes(b"video")
        clip = Clip(name="new", media_type="video/mp4", size=5, width=64, height=48)
        added = store.add(clip, partial, "10.0.0.1")
        assert jobs.start(added.job.id) is not None
        jobs.complete(added.job.id, 1, ())
        store.delete(clip.id)

    def read(**asked: Any) -> None:
        views, _ = read_page(store, ClipQuery(CLIPS_OF_A_PAGE, **asked))
        LISTED.dump_json(views)

    works: dict[str, Callable[[], object]] = {
        "the first page of the list": read,
        "a page from its middle": lambda: read(after=clip_id),
        "the clips whose poses are not found": lambda: read(statuses=OPEN),
        "a name that few have": lambda: read(name=f"DIVE {clips // 2}."),
        "a name that none has": lambda: read(name="wreck"),
        "the number of clips": store.count,
        "one clip": lambda: store.get(clip_id),
        "add a clip, run and end its job, delete it": add,
        "look for jobs that others left": jobs.take_over,
        "open jobs of an address": lambda: jobs.count_open("10.0.0.1"),
        "what an owner keeps": lambda: QuotaStore(database).usage("1"),
        "number of changes": lambda: store.changes,
    }
    for name, work in works.items():
        print(f"{clips:9,d} clips: {name}: {milliseconds(work)}", flush=True)
    if clips <= longest_list:
        print(f"{clips:9,d} clips: the rows of the whole list: {milliseconds(store.all, 1)}")


async def measure_watchers(counts: list[int], events: int) -> None:
    """Print the processor time of sending events to watchers, per watcher and event."""
    with tempfile.TemporaryDirectory() as folder:
        settings = Settings(data_dir=Path(folder), samples_dir=Path(folder) / "none")
        async with open_studio(settings) as studio:
            for count in counts:
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
                    scope: dict[str, Any] = {"type": "http", "method": "GET", "headers": []}
                    await stream(scope, receive, send)

                watchers = [asyncio.create_task(watch()) for _ in range(count)]
                while ready < count:
                    assert not any(watcher.done() for watcher in watchers), "a watcher left"
                    await asyncio.sleep(0.01)
                before = time.process_time()
                for number in range(events):
                    studio.broadcast.publish("languages", id=f"{number}")
                    while received < count * (number + 1):
                        await asyncio.sleep(0)
                spent = time.process_time() - before
                for watcher in watchers:
                    watcher.cancel()
                await asyncio.gather(*watchers, return_exceptions=True)
                print(
                    f"{count:6,d} watchers: {1e6 * spent / events / count:.0f} us of a core each "
                    f"and event, {1000 * spent / events:.0f} ms for all"
                )


def main() -> None:
    """Measure rows, then watchers."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--clips", type=int, nargs="*", default=[1000, 10_000, 100_000, 1_000_000])
    parser.add_argument("--longest-list", type=int, default=100_000)
    parser.add_argument("--watchers", type=int, nargs="*", default=[100, 1000, 10_000])
    parser.add_argument("--events", type=int, default=10)
    parser.add_argument("--database", help="URL of an empty PostgreSQL; by default SQLite")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        database = Database(given.database or f"sqlite:///{folder}/studio.db")
        database.migrate()
        filled = 0
        for clips in sorted(given.clips):
            fill(database, filled, clips)
            filled = clips
            measure_rows(database, Path(folder) / "clips", clips, given.longest_list)
        database.close()
    asyncio.run(measure_watchers(given.watchers, given.events))


if __name__ == "__main__":
    main()
