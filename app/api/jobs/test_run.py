"""Test run job: recognises the takes of a test set by one revision of their language."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

from starlette.concurrency import run_in_threadpool

from app.api.events.broadcast import Event
from app.api.jobs.job import Progress, Report
from app.store import LabelledTake


class TestRunJob:
    """Recognises one take after the other; what is done stays when it is cancelled.

    Parameters
    ----------
    language_id, revision
        The language, for the events.
    takes
        The takes to recognise.
    recognize
        Recognises one and keeps the result.

    """

    __test__ = False
    resumable: Literal[False] = False

    def __init__(
        self,
        language_id: str,
        revision: int,
        takes: Sequence[LabelledTake],
        recognize: Callable[[LabelledTake], None],
    ) -> None:
        self._language_id = language_id
        self._revision = revision
        self._takes = takes
        self._recognize = recognize

    @property
    def key(self) -> str:
        """The revision: two runs of it would do the same."""
        return f"test {self._language_id} {self._revision}"

    def event(self, progress: Progress) -> Event:
        """Return how far the run is."""
        content = {
            "id": self._language_id,
            "revision": self._revision,
            "done": progress.done,
            "total": progress.total,
        }
        return Event("tests", content)

    async def run(self, report: Report) -> int:
        """Recognise the takes, and return how many they were."""
        for done, take in enumerate(self._takes):
            report(Progress("recognising", done, len(self._takes)))
            await run_in_threadpool(self._recognize, take)
        report(Progress("recognising", len(self._takes), len(self._takes)))
        return len(self._takes)
