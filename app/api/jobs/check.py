"""Check job: computes the health report of a language's revision in a thread."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from typing import Any, Literal

from starlette.concurrency import run_in_threadpool

from app.api.events.broadcast import Event
from app.api.jobs.job import Progress, Report
from app.recognition import Language
from app.recognition.health.check import check_health

CACHED_REPORTS = 64
"""Reports kept ready: one of twenty gestures is about a hundred kilobytes of Python objects."""

REPORT_EVERY = 8
"""Pieces of work, each a take or a movement of some ten milliseconds, between two events: ten a
second are as smooth as a progress bar need be."""

_reports: OrderedDict[str, dict[str, Any]] = OrderedDict()


class CheckJob:
    """Checks one revision of a language; everybody who asks for it meanwhile waits for one job.

    Parameters
    ----------
    language_id, revision
        The language, for the events.
    document
        The revision's language file.

    """

    resumable: Literal[False] = False

    def __init__(self, language_id: str, revision: int, document: str) -> None:
        self._language_id = language_id
        self._revision = revision
        self._document = document

    @property
    def key(self) -> str:
        """Digest of the document: the same document gives the same report."""
        return f"check {hashlib.sha256(self._document.encode()).hexdigest()}"

    def event(self, progress: Progress) -> Event:
        """Return how far the check is."""
        content = {
            "id": self._language_id,
            "revision": self._revision,
            "stage": progress.stage,
            "done": progress.done,
            "total": progress.total,
        }
        return Event("checks", content)

    async def run(self, report: Report) -> dict[str, Any]:
        """Compute the report, or return the kept one."""
        key = self.key
        if key not in _reports:
            _reports[key] = await run_in_threadpool(self._compute, report)
            while len(_reports) > CACHED_REPORTS:
                _reports.popitem(last=False)
        else:
            _reports.move_to_end(key)
        return _reports[key]

    def _compute(self, report: Report) -> dict[str, Any]:
        def progress(stage: str, done: int, total: int) -> None:
            if done % REPORT_EVERY == 1:
                report(Progress(stage, done, total))

        return check_health(Language.from_json(self._document), progress=progress).to_dict()
