"""Dask task: runs a worker process on a machine of the cluster, and sends the server its lines."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from distributed import get_worker

from app.api.workers.executor import COMMAND, PACKAGE_PARENT
from app.api.workers.rights import environment_of_workers, rights_to_models
from app.api.workers.task_folders import Contents, Workspace, Written
from app.recognition.models.storage import models_dir
from app.store.errors import StoreUnavailable

STARTED, LINE, FILE, ENDED, LOST = "started", "line", "file", "ended", "lost"
"""Kinds of messages; `LOST` means that the clip cannot be fetched now."""

MOST_TOLD = 64 * 1024
"""Most bytes of a file sent as a message: the scheduler keeps the newest thousand messages."""

_processes: dict[str, subprocess.Popen[bytes]] = {}
"""Running processes of this Dask worker, by task."""


def run_worker(
    arguments: Sequence[str], task: str, topic: str, workspace: Workspace | None
) -> Contents:
    """Run a worker process to its end; send each step as ``(task, kind, content)`` under `topic`.

    If it works in its own folder, small files that it has written are sent before the line that
    follows them; larger ones are returned.
    """
    tell = partial(_tell, topic, task)
    if workspace is None:
        for line in _lines(arguments, task, tell):
            tell(LINE, line)
        tell(ENDED, "")
        return {}
    with tempfile.TemporaryDirectory(prefix="osg-task-") as place:
        folder = Path(place)
        try:
            own = workspace.prepare(folder, arguments)
        except StoreUnavailable as error:
            tell(LOST, str(error))
            return {}
        written = Written(folder, workspace)
        for line in _lines(own, task, tell):
            for path, content in written.take(MOST_TOLD):
                tell(FILE, (path, content))
            tell(LINE, line)
        result = dict(written.take())
        tell(ENDED, "")
        return result


def _tell(topic: str, task: str, kind: str, content: str | tuple[str, bytes]) -> None:
    get_worker().log_event(topic, (task, kind, content))


def _lines(arguments: Sequence[str], task: str, tell: Callable[[str, str], None]) -> Iterator[str]:
    """Yield the lines of a worker process."""
    process = subprocess.Popen(
        [sys.executable, *COMMAND, *rights_to_models(models_dir()), *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=PACKAGE_PARENT,
        env=environment_of_workers(),
    )
    _processes[task] = process
    try:
        tell(STARTED, get_worker().address)
        assert process.stdout is not None
        for line in process.stdout:
            yield line.decode()
    finally:
        _processes.pop(task, None)
        process.kill()
        process.wait()


def end_worker(task: str) -> None:
    """End the process of a task, where it runs on this Dask worker."""
    if (process := _processes.get(task)) is not None:
        process.kill()
