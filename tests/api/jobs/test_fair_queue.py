"""Waiting jobs: in turn between clients, in order within each."""

import asyncio

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.api.jobs.extraction_queue import FairQueue


async def drained(entries: list[tuple[str, str]]) -> list[str]:
    queue = FairQueue()
    for client, job_id in entries:
        await queue.put(client, job_id)
    return [await queue.get() for _ in entries]


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
    async def wait() -> str:
        queue = FairQueue()
        waiting = asyncio.create_task(queue.get())
        await asyncio.sleep(0)
        await queue.put("client", "job")
        return await waiting

    assert asyncio.run(wait()) == "job"
