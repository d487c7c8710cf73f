"""Bag export job: writes a clip and its recognitions as MCAP in a worker process."""

from __future__ import annotations

import time
from contextlib import aclosing
from pathlib import Path
from typing import Literal

from app.api.events.broadcast import Event
from app.api.jobs.job import Progress, Report
from app.api.jobs.time_left import TimeLeft
from app.api.workers.bag_export_request import BagExportRequest
from app.api.workers.clip_files import ClipFiles
from app.api.workers.worker_messages import Failed, Finished, Progressed
from app.api.workers.worker_processes import Workers


class BagExportJob:
    """Writes one bag; every export is a job and a file of its own.

    Parameters
    ----------
    export_id
        Id of the export in its events, because a clip can have several.
    request
        The content of the bag.
    target
        The file to write.
    files
        The parts of the clip.
    workers
        Starts the process.

    """

    resumable: Literal[False] = False

    def __init__(
        self,
        export_id: str,
        request: BagExportRequest,
        target: Path,
        files: ClipFiles,
        workers: Workers,
    ) -> None:
        self._export_id = export_id
        self._request = request
        self._target = target
        self._files = files
        self._workers = workers

    @property
    def key(self) -> str:
        """Name of the file."""
        return f"session {self._target.name}"

    def event(self, progress: Progress) -> Event:
        """Return the event with the progress of the export."""
        content = {
            "id": self._export_id,
            "stage": progress.stage,
            "done": progress.done,
            "total": progress.total,
            "eta_s": progress.eta_s,
        }
        return Event("exports", content)

    async def run(self, report: Report) -> Finished | Failed:
        """Write the file, and return the outcome."""
        request = self._request.model_dump_json().encode()
        left = TimeLeft()
        async with aclosing(self._workers.write_bag(request, self._target, self._files)) as steps:
            async for step in steps:
                if not isinstance(step, Progressed):
                    return step
                eta = left.estimate(step.done, step.total, time.monotonic())
                report(Progress(step.stage, step.done, step.total, eta))
        raise AssertionError("a worker's last message says how it ended")
