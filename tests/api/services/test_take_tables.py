"""The job that makes the table of takes: it reports progress, and can end between two takes."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable

import pytest

from app.api.events.broadcast import Broadcast
from app.api.jobs.job import JobCancelled, JobRunner
from app.api.services.take_tables import take_table_job
from app.api.workers.worker_messages import Progress
from app.evaluation.take_table import Row
from app.store import Clip


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
