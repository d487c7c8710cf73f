"""Dask task: runs a worker process on a machine of the cluster, and tells the server its lines."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence

from distributed import get_worker

from app.api.workers.executor import COMMAND, PACKAGE_PARENT

STARTED, LINE, ENDED = "started", "line", "ended"
"""What a message is about."""

_processes: dict[str, subprocess.Popen[bytes]] = {}
"""The running processes of this Dask worker by task."""


def run_worker(arguments: Sequence[str], task: str, topic: str) -> None:
    """Run a worker process to its end; tell each line as ``(task, kind, line)`` under `topic`."""
    worker = get_worker()
    process = subprocess.Popen(
        [sys.executable, *COMMAND, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        cwd=PACKAGE_PARENT,
    )
    _processes[task] = process
    try:
        worker.log_event(topic, (task, STARTED, ""))
        assert process.stdout is not None
        for line in process.stdout:
            worker.log_event(topic, (task, LINE, line.decode()))
        worker.log_event(topic, (task, ENDED, ""))
    finally:
        _processes.pop(task, None)
        process.kill()
        process.wait()


def end_worker(task: str) -> None:
    """End the process of a task, where it runs on this Dask worker."""
    if (process := _processes.get(task)) is not None:
        process.kill()
