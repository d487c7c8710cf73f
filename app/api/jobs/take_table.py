"""Take table job: recognises all takes of several clips."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Literal

from app.api.events.broadcast import Event
from app.api.jobs.job import Progress, Report
from app.api.jobs.places import compute_in_place
from app.api.jobs.time_left import TimeLeft
from app.store import Clip

Rows = list[dict[str, Any]]


class TakeTableJob:
    """Recognises one clip after the other; every table is a job of its own.

    Parameters
    ----------
    table_id
        Id of the table in its events.
    clips
        The clips.
    recognize
        Returns the rows of one clip; reports the share of its takes that is done to its callback.
    places
        Limits the computations that run at the same time; further ones wait.

    """

    resumable: Literal[False] = False

    def __init__(
        self,
        table_id: str,
        clips: Sequence[Clip],
        recognize: Callable[[Clip, Callable[[float], None]], Rows],
        places: asyncio.Semaphore,
    ) -> None:
        self._table_id = table_id
        self._clips = clips
        self._recognize = recognize
        self._places = places

    @property
    def key(self) -> str:
        """Id of the table, unique to this run."""
        return f"table {self._table_id} {id(self)}"

    def event(self, progress: Progress) -> Event:
        """Return the event with the progress of the table."""
        content = {
            "id": self._table_id,
            "stage": progress.stage,
            "done": progress.done,
            "total": progress.total,
            "eta_s": progress.eta_s,
        }
        return Event("tables", content)

    async def run(self, report: Report) -> Rows:
        """Recognise the takes, and return the rows in the order of the clips."""
        rows: Rows = []
        left, done = TimeLeft(), 0
        sizes = [max(1, clip.frames or 0) for clip in self._clips]
        for at, (clip, size) in enumerate(zip(self._clips, sizes, strict=True), start=1):
            stage, before = f"clip {at} of {len(sizes)}: {clip.name}", done

            def advance(share: float, stage: str = stage, before: int = before) -> None:
                frames = before + round(share * size)  # noqa: B023  # called in this turn alone
                eta = left.estimate(frames, sum(sizes), time.monotonic())
                report(Progress(stage, frames, sum(sizes), eta))

            advance(0.0)
            recognize = partial(self._recognize, clip, advance)
            rows += await compute_in_place(self._places, recognize)
            done += size
        return rows
