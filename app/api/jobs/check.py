"""Check job: computes the health report of a language's revision in a worker process."""

from __future__ import annotations

import hashlib
import json
from collections import OrderedDict
from contextlib import aclosing
from pathlib import Path
from typing import Any, Literal

from app.api.events.broadcast import Event
from app.api.jobs.job import Progress, Report
from app.api.workers.worker_messages import Failed, Progressed
from app.api.workers.worker_processes import Workers

CACHED_REPORTS = 64
"""Reports kept ready: one of twenty gestures is about a hundred kilobytes of Python objects."""

_reports: OrderedDict[str, dict[str, Any]] = OrderedDict()


class CheckJob:
    """Checks one revision of a language; all requests for it meanwhile wait for the same job.

    Parameters
    ----------
    language_id, revision
        The language, for the events.
    document
        The revision's language file.
    workers
        Starts the process.
    folder
        Folder for its files.

    """

    resumable: Literal[False] = False

    def __init__(
        self, language_id: str, revision: int, document: str, workers: Workers, folder: Path
    ) -> None:
        self._workers = workers
        self._folder = folder
        self._language_id = language_id
        self._revision = revision
        self._document = document

    @property
    def key(self) -> str:
        """Digest of the document: the same document gives the same report."""
        return f"check {hashlib.sha256(self._document.encode()).hexdigest()}"

    def event(self, progress: Progress) -> Event:
        """Return the event with the progress of the check."""
        content = {
            "id": self._language_id,
            "revision": self._revision,
            "stage": progress.stage,
            "done": progress.done,
            "total": progress.total,
        }
        return Event("checks", content)

    async def run(self, report: Report) -> dict[str, Any] | Failed:
        """Return the computed or kept report, or the reason for its absence."""
        key = self.key
        if key not in _reports:
            computed = await self._compute(report)
            if isinstance(computed, Failed):
                return computed
            _reports[key] = computed
            while len(_reports) > CACHED_REPORTS:
                _reports.popitem(last=False)
        else:
            _reports.move_to_end(key)
        return _reports[key]

    async def _compute(self, report: Report) -> dict[str, Any] | Failed:
        async with aclosing(self._workers.check_language(self._document, self._folder)) as steps:
            async for step in steps:
                if isinstance(step, Progressed):
                    report(Progress(step.stage, step.done, step.total))
                elif isinstance(step, Failed):
                    return step
                else:
                    computed: dict[str, Any] = json.loads(step)
                    return computed
        raise AssertionError("the last step is the report, or why there is none")
