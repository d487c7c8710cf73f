"""Waiting jobs: in turn between clients, in order within each."""

import asyncio

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.api.jobs.extraction_queue import FairQueue


async def drained(entries: list[tuple[str, str]]) -> list[str]:
    queue = FairQueue(most=1)
    for client, job_id in entries:
        await queue.put(client, job_id)
    found = []
    for _ in entries:
        client, job_id = await queue.get()
        queue.release(client)
        found.append(job_id)
    return found


@pytest.mark.withstands(row="H23")
def test_one_job_does_not_wait_for_anothers_hundred() -> None:
    entries = [("many", str(index)) for index in range(100)] + [("few", "x"), ("few", "y")]
    order = asyncio.run(drained(entries))
    assert order[:4] == ["0", "x", "1", "y"]
    assert order[4:] == [str(index) for index in range(2, 100)]


@given(st.lists(st.sampled_from("abc"), max_size=30))
def test_nothing_is_lost_and_each_clients_order_is_kept(clients: list[str]) -> None:
    entries = [(client, f"{client}{index}") for index, client in enumerate(clients)]
    order = asyncio.run(drained(entries))
    assert sorted(order) == sorted(job_id for _, job_id in entries)
    for client in "abc":
        mine = [job_id for job_id in order if job_id.startswith(client)]
        assert mine == [job_id for owner, job_id in entries if owner == client]


def test_whoever_waits_gets_what_comes() -> None:
    async def wait() -> tuple[str, str]:
        queue = FairQueue(most=1)
        waiting = asyncio.create_task(queue.get())
        await asyncio.sleep(0)
        await queue.put("client", "job")
        return await waiting

    assert asyncio.run(wait()) == ("client", "job")


async def tried(queue: FairQueue) -> str | None:
    """Return the job that begins now; None if all must wait."""
    taking = asyncio.create_task(queue.get())
    for _ in range(5):
        await asyncio.sleep(0)
    if taking.done():
        return taking.result()[1]
    taking.cancel()
    return None


def test_a_long_job_holds_its_own_clients_others_and_nobody_elses() -> None:
    async def take_turns() -> None:
        queue = FairQueue(most=1)
        for client, job_id in (("guest", "long"), ("guest", "next"), ("maker", "own")):
            await queue.put(client, job_id)
        assert await tried(queue) == "long"
        assert await tried(queue) == "own"
        assert await tried(queue) is None
        queue.release("maker")
        assert await tried(queue) is None
        queue.release("guest")
        assert await tried(queue) == "next"

    asyncio.run(take_turns())


def test_whoever_comes_while_all_places_hold_a_long_job_is_not_kept_waiting() -> None:
    async def come_late() -> tuple[str, str]:
        queue = FairQueue(most=1)
        await queue.put("guest", "long")
        await queue.get()
        waiting = [asyncio.create_task(queue.get())]
        await asyncio.sleep(0)
        await queue.put("guest", "next")
        await queue.put("maker", "own")
        return await waiting[0]

    assert asyncio.run(come_late()) == ("maker", "own")
