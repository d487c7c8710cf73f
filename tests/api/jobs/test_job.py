"""Jobs: one run per key, progress as events, cancelling for all who wait, the time left."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

import pytest

from app.api.events.broadcast import Broadcast, Event
from app.api.jobs.job import Job, JobCancelled, JobRunner, Report, TimeLeft, events_about
from app.api.workers.worker_messages import Progress


class Counting:
    """A job that reports a step, then waits until it is released; counts its runs."""

    def __init__(
        self, key: str = "count", *, resumable: bool = False, cached: bool = False
    ) -> None:
        self.runs = 0
        self.go_on = asyncio.Event()
        event = events_about("counts", id=key)
        self.job = Job("counting", key, event, self.run, resumable=resumable, cached=cached)

    async def run(self, report: Report) -> int:
        self.runs += 1
        report(Progress(stage="counting", done=self.runs, total=2))
        await self.go_on.wait()
        return self.runs


def run(scenario: Callable[[JobRunner, Broadcast], Awaitable[None]]) -> None:
    async def start() -> None:
        broadcast = Broadcast()
        await scenario(JobRunner(broadcast), broadcast)

    asyncio.run(start())


def test_who_asks_for_a_running_job_waits_for_it_and_its_progress_is_an_event() -> None:
    async def scenario(runner: JobRunner, broadcast: Broadcast) -> None:
        job = Counting()
        with broadcast.subscribe() as events:
            waiting = [asyncio.create_task(runner.run(job.job)) for _ in range(2)]
            await asyncio.sleep(0.01)
            assert runner.progress("count") == Progress(stage="counting", done=1, total=2)
            job.go_on.set()
            assert await asyncio.gather(*waiting) == [1, 1]
            await asyncio.sleep(0.01)
            assert runner.progress("count") is None
            broadcast.close()
            assert [event async for event in events] == [
                Event(
                    "counts",
                    {"id": "count", "stage": "counting", "done": 1, "total": 2, "eta_s": None},
                )
            ]
        assert await runner.run(job.job) == 2  # over: it runs anew

    run(scenario)


def test_cancelling_reaches_all_who_wait_and_the_job_can_begin_anew() -> None:
    async def scenario(runner: JobRunner, _broadcast: Broadcast) -> None:
        job = Counting()
        waiting = [asyncio.create_task(runner.run(job.job)) for _ in range(2)]
        await asyncio.sleep(0.01)
        assert await runner.cancel("count")
        assert not await runner.cancel("count")
        for each in waiting:
            with pytest.raises(JobCancelled):
                await each
        job.go_on.set()
        assert await runner.run(job.job) == 2

    run(scenario)


def test_a_caller_that_gives_up_does_not_end_the_job() -> None:
    async def scenario(runner: JobRunner, _broadcast: Broadcast) -> None:
        job = Counting()
        one, other = (asyncio.create_task(runner.run(job.job)) for _ in range(2))
        await asyncio.sleep(0.01)
        one.cancel()
        job.go_on.set()
        assert await other == 1

    run(scenario)


def test_stopping_ends_what_no_later_start_takes_up() -> None:
    async def scenario(runner: JobRunner, _broadcast: Broadcast) -> None:
        lost, kept = Counting("lost"), Counting("kept", resumable=True)
        tasks = {job.job.key: asyncio.create_task(runner.run(job.job)) for job in (lost, kept)}
        await asyncio.sleep(0.01)
        await runner.stop()
        with pytest.raises(JobCancelled):
            await tasks["lost"]
        with pytest.raises(JobCancelled):
            await runner.run(Counting("late").job)
        kept.go_on.set()
        assert await tasks["kept"] == 1

    run(scenario)


def test_a_result_is_kept_ready_for_jobs_that_would_have_the_same() -> None:
    async def scenario(runner: JobRunner, _broadcast: Broadcast) -> None:
        for key, cached, runs in (("cached", True, 1), ("anew", False, 2)):
            job = Counting(key, cached=cached)
            job.go_on.set()
            assert await runner.run(job.job) == 1
            assert await runner.run(job.job) == runs

    run(scenario)


def test_nothing_is_estimated_from_the_first_frames() -> None:
    left = TimeLeft()
    assert left.estimate(1, 239, now=100.0) is None
    assert left.estimate(2, 239, now=100.1) is None
    assert left.estimate(11, 239, now=104.0) is None


def test_frames_before_the_first_report_do_not_count_towards_the_rate() -> None:
    left = TimeLeft()
    # Ten frames come at once; then four a second.
    assert left.estimate(10, 110, now=0.0) is None
    assert left.estimate(30, 110, now=5.0) == 20.0
    assert left.estimate(110, 110, now=25.0) == 0.0
