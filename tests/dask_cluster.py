"""A real Dask cluster in processes of its own, each of which may be killed."""

from __future__ import annotations

import gc
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.api.serving import lasting_port


class Cluster:
    """A scheduler and its workers.

    Parameters
    ----------
    folder
        Where they keep their files and logs.

    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.port = lasting_port()
        self.workers: list[subprocess.Popen[bytes]] = []
        self.scheduler = self._start_scheduler()

    @property
    def address(self) -> str:
        """The scheduler's ``HOST:PORT``."""
        return f"127.0.0.1:{self.port}"

    def add_worker(self) -> None:
        """Start a worker with a place for one task."""
        options = ["--nthreads", "1", "--no-nanny", "--no-dashboard"]
        self.workers.append(self._run("worker", f"tcp://{self.address}", *options))

    def restart_scheduler(self) -> None:
        """Kill the scheduler, and start another one at the same address."""
        self.scheduler.kill()
        self.scheduler.wait()
        self.scheduler = self._start_scheduler()

    def stop(self) -> None:
        """Kill all of it."""
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()

    def _start_scheduler(self) -> subprocess.Popen[bytes]:
        options = ["--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard"]
        return self._run("scheduler", *options)

    def _run(self, kind: str, *options: str) -> subprocess.Popen[bytes]:
        with (self._folder / f"{kind}-{time.monotonic_ns()}.log").open("wb") as log:
            command = [sys.executable, "-m", "dask", kind, *options]
            return subprocess.Popen(command, stdout=log, stderr=log, cwd=self._folder)


@contextmanager
def dask_cluster(folder: Path, workers: int = 2) -> Iterator[Cluster]:
    """Run a cluster until the context ends; skip where Dask is not installed."""
    pytest.importorskip("distributed")
    cluster = Cluster(folder)
    try:
        for _ in range(workers):
            cluster.add_worker()
        yield cluster
    finally:
        cluster.stop()
        # Tornado's futures that nobody awaited are logged as errors when they are collected, which
        # would be during another test.
        gc.collect()
