"""The table of takes over HTTP: all takes of clips, with the columns of the command line."""

from __future__ import annotations

import asyncio
import csv
import io
import threading
from collections.abc import Callable

import httpx
import pytest

from app.api.events.broadcast import Broadcast
from app.api.jobs.job import JobCancelled, JobRunner
from app.api.routes.languages.takes import take_table_job
from app.api.workers.worker_messages import Progress
from app.evaluation.take_table import COLUMNS, Row
from app.store import Clip
from tests.api.languages import LANGUAGES
from tests.api.running import Running, assert_problem
from tests.browser.library import add_clip, library_of


def test_all_takes_of_clips_are_in_one_table(server: Running, client: httpx.Client) -> None:
    library = library_of(server, client, "dives")
    both = add_clip(server, "line", "circle", name="both.mp4")
    first = client.get(f"/api/v1/clips/{both}/takes").json()[0]
    labelled = {"clip_id": both, "start": first["start"], "end": first["end"], "expected": "line"}
    address = f"{LANGUAGES}/{library.language}"
    added = client.post(f"{address}/test-set", json={"takes": [labelled]})
    assert added.status_code == 201, added.text
    body = {"id": "mine", "clip_ids": [library.clip, both]}
    answer = client.post(f"{address}/take-table", json=body)
    assert answer.status_code == 200, answer.text
    table = answer.json()
    assert [(row["clip"], row["take"], row["label"]) for row in table["rows"]] == [
        ("dives.mp4", 1, "circle"),
        ("both.mp4", 1, "line"),
        ("both.mp4", 2, "circle"),
    ]
    assert [row["runner_up"] for row in table["rows"]] == ["line", "circle", "line"]
    assert [row["expected"] for row in table["rows"]] == [None, "line", None]
    assert table["rows"][1]["start"] == pytest.approx(first["start"], abs=1e-3)
    written = list(csv.DictReader(io.StringIO(table["csv"])))
    assert list(written[0]) == list(COLUMNS)
    assert [row["label"] for row in written] == ["circle", "line", "circle"]
    assert client.get(f"/api/v1/recognitions?clip_id={both}").json() == []


@pytest.mark.parametrize("trigger", ["salute", "none"])
def test_a_row_says_of_a_take_what_its_recognition_says(
    server: Running, client: httpx.Client, trigger: str
) -> None:
    library = library_of(server, client, f"by {trigger}")
    address = f"{LANGUAGES}/{library.language}"
    client.put(f"{address}/trigger", json={"kind": trigger}).raise_for_status()
    clip = add_clip(server, "line", "circle", name="both.mp4")
    takes = client.get(f"/api/v1/clips/{clip}/takes?language_id={library.language}").json()
    assert takes
    body = {"id": f"by {trigger}", "clip_ids": [clip]}
    rows = client.post(f"{address}/take-table", json=body).json()["rows"]
    told = ("nearest", "confidence")
    for row, take in zip(rows, takes, strict=True):
        wanted = {"start": take["start"], "end": take["end"]}
        body = {"clip_id": clip, "language_id": library.language} | wanted
        recognition = client.post("/api/v1/recognitions", json=body).json()
        assert [row[name] for name in told] == pytest.approx(
            [recognition[name] for name in told], abs=1e-3
        )


def test_a_table_of_an_absent_clip_is_refused(server: Running, client: httpx.Client) -> None:
    library = library_of(server, client, "lone")
    body = {"id": "mine", "clip_ids": ["absent"]}
    address = f"{LANGUAGES}/{library.language}/take-table"
    assert_problem(client.post(address, json=body), 404, "not_found")


def clip_of(name: str, frames: int) -> Clip:
    return Clip(name=name, media_type="video/mp4", size=1, width=4, height=3, frames=frames)


def test_progress_counts_the_frames_of_all_clips() -> None:
    told: list[Progress] = []

    def recognize(clip: Clip, advance: Callable[[float], None]) -> list[Row]:
        advance(0.5)
        return [{"clip": clip.name}]

    clips = [clip_of("a.mp4", 100), clip_of("b.mp4", 300)]
    rows = asyncio.run(
        take_table_job("mine", clips, recognize, asyncio.Semaphore()).run(told.append)
    )
    assert rows == [{"clip": "a.mp4"}, {"clip": "b.mp4"}]
    assert [(each.stage, each.done, each.total) for each in told] == [
        ("clip 1 of 2: a.mp4", 0, 400),
        ("clip 1 of 2: a.mp4", 50, 400),
        ("clip 2 of 2: b.mp4", 100, 400),
        ("clip 2 of 2: b.mp4", 250, 400),
    ]


def test_a_cancelled_table_recognises_no_further_take() -> None:
    begun, cancelled, ended = threading.Event(), threading.Event(), threading.Event()
    takes: list[int] = []

    def recognize(clip: Clip, advance: Callable[[float], None]) -> list[Row]:
        try:
            for take in range(3):
                takes.append(take)
                begun.set()
                assert cancelled.wait(60)
                advance(take / 3)
        finally:
            ended.set()
        return []

    async def scenario() -> None:
        runner = JobRunner(Broadcast())
        clips, places = [clip_of("a.mp4", 9), clip_of("b.mp4", 9)], asyncio.Semaphore()
        job = take_table_job("mine", clips, recognize, places)
        waiting = asyncio.create_task(runner.run(job))
        await asyncio.to_thread(begun.wait, 60)
        cancelling = asyncio.create_task(runner.cancel(job.key))
        await asyncio.sleep(0.05)  # the cancellation comes before the thread continues
        assert places.locked()  # the next table waits until this one's thread has ended
        cancelled.set()
        assert await cancelling
        with pytest.raises(JobCancelled):
            await waiting
        await asyncio.to_thread(ended.wait, 60)
        await places.acquire()

    asyncio.run(scenario())
    assert takes == [0]
