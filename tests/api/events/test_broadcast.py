"""Events reach every listener, from any thread, and never pile up."""

import asyncio
import threading

import pytest

from app.api.events.broadcast import MOST_UNREAD, Broadcast, Event


def test_every_listener_hears_news_from_any_thread() -> None:
    async def listen() -> list[list[Event]]:
        broadcast = Broadcast()
        with broadcast.subscribe() as one, broadcast.subscribe() as other:
            thread = threading.Thread(target=broadcast.publish, args=("clips",), kwargs={"id": "a"})
            thread.start()
            thread.join()
            await asyncio.sleep(0)
            broadcast.close()
            return [[news async for news in listener] for listener in (one, other)]

    assert asyncio.run(listen()) == [[Event("clips", {"id": "a"})]] * 2


def test_a_listener_that_does_not_read_keeps_the_newest() -> None:
    async def listen() -> list[int]:
        broadcast = Broadcast()
        with broadcast.subscribe() as listener:
            for number in range(2 * MOST_UNREAD):
                broadcast.publish("jobs", id=number)
            await asyncio.sleep(0)
            broadcast.close()
            return [news.data["id"] async for news in listener]

    received = asyncio.run(listen())
    assert received[-1] == 2 * MOST_UNREAD - 1
    assert len(received) < MOST_UNREAD


def test_who_comes_after_the_end_hears_nothing_and_waits_for_nothing() -> None:
    async def listen() -> list[Event]:
        broadcast = Broadcast()
        broadcast.close()
        with broadcast.subscribe() as listener:
            return [news async for news in listener]

    assert asyncio.run(listen()) == []


def test_publishing_after_the_loop_is_closed_does_nothing() -> None:
    async def make() -> Broadcast:
        return Broadcast()

    asyncio.run(make()).publish("clips", id="late")


@pytest.mark.parametrize(("pause", "told"), [(0.0, [1, 2, 3, "end", 1]), (1000.0, [1, "end", 1])])
def test_many_listeners_hear_less_often_how_far_a_job_is_and_always_of_its_end(
    monkeypatch: pytest.MonkeyPatch, pause: float, told: list[object]
) -> None:
    monkeypatch.setattr("app.api.events.broadcast.SECONDS_PER_STREAM", pause)

    async def listen() -> list[object]:
        broadcast = Broadcast()
        with broadcast.subscribe() as listener:
            for done in (1, 2, 3):
                broadcast.publish("jobs", id="a", progress={"stage": "poses", "done": done})
            broadcast.publish("jobs", id="a")
            broadcast.publish("jobs", id="a", progress={"stage": "poses", "done": 1})
            await asyncio.sleep(0)
            broadcast.close()
            return [
                news.data["progress"]["done"] if "progress" in news.data else "end"
                async for news in listener
            ]

    assert asyncio.run(listen()) == told
