"""Take table job: recognises all takes of several clips in threads."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any
from uuid import uuid4

from app.api.jobs.job import Job, Progress, Report, TimeLeft, compute_in_place, events_about
from app.store import Clip

Rows = list[dict[str, Any]]


def take_table_job(
    table_id: str,
    clips: Sequence[Clip],
    recognize: Callable[[Clip, Callable[[float], None]], Rows],
    places: asyncio.Semaphore,
) -> Job[Rows]:
    """Return a job that recognises one clip after the other; every table is a job of its own.

    Parameters
    ----------
    table_id
        Id of the table in its events.
    clips
        The clips, in the order of the rows.
    recognize
        Returns the rows of one clip; reports the share of its takes that is done to its callback.
    places
        Limits the computations that run at the same time; further ones wait.

    """

    async def run(report: Report) -> Rows:
        rows: Rows = []
        left, done = TimeLeft(), 0
        sizes = [max(1, clip.frames or 0) for clip in clips]
        for at, (clip, size) in enumerate(zip(clips, sizes, strict=True), start=1):
            stage, before = f"clip {at} of {len(sizes)}: {clip.name}", done

            def advance(share: float, stage: str = stage, before: int = before) -> None:
                frames = before + round(share * size)  # noqa: B023  # called in this turn alone
                eta = left.estimate(frames, sum(sizes), time.monotonic())
                report(Progress(stage, frames, sum(sizes), eta))

            advance(0.0)
            rows += await compute_in_place(places, partial(recognize, clip, advance))
            done += size
        return rows

    key = f"table {table_id} {uuid4().hex}"
    return Job("take_table", key, events_about("tables", id=table_id), run)
