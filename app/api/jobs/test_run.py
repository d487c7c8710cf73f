"""Test run job: recognises the takes of a test set in a worker process."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import aclosing
from pathlib import Path
from typing import Literal

from starlette.concurrency import run_in_threadpool

from app.api.events.broadcast import Event
from app.api.jobs.job import Progress, Report
from app.api.workers.test_takes import RecognizedTake, TestRunRequest
from app.api.workers.worker_messages import Failed
from app.api.workers.worker_processes import Workers


class TestRunJob:
    """Recognises one take after the other; finished results stay when it is cancelled.

    Parameters
    ----------
    language_id, revision
        The language, for the events.
    request
        The takes to recognise.
    keep
        Stores the result of the take with that index.
    workers
        Starts the process.
    folder
        Where its files may be.

    """

    __test__ = False
    resumable: Literal[False] = False

    def __init__(
        self,
        language_id: str,
        revision: int,
        request: TestRunRequest,
        keep: Callable[[int, RecognizedTake], None],
        workers: Workers,
        folder: Path,
    ) -> None:
        self._language_id = language_id
        self._revision = revision
        self._request = request
        self._keep = keep
        self._workers = workers
        self._folder = folder

    @property
    def key(self) -> str:
        """Id of the revision, because two runs of it would do the same."""
        return test_run_key(self._language_id, self._revision)

    def event(self, progress: Progress) -> Event:
        """Return the event with the progress of the run."""
        content = {
            "id": self._language_id,
            "revision": self._revision,
            "done": progress.done,
            "total": progress.total,
        }
        return Event("tests", content)

    async def run(self, report: Report) -> Failed | None:
        """Recognise the takes; return the failure of the process, if any."""
        done, total = 0, len(self._request.takes)
        report(Progress("recognising", done, total))
        if not total:
            return None
        async with aclosing(self._workers.recognize_takes(self._request, self._folder)) as steps:
            async for step in steps:
                if isinstance(step, Failed):
                    return step
                await run_in_threadpool(self._keep, done, step)
                done += 1
                report(Progress("recognising", done, total))
        return None


def test_run_key(language_id: str, revision: int) -> str:
    """Return the identity of the run of a revision among the jobs."""
    return f"test {language_id} {revision}"
