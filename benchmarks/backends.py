"""Backends of a server in crash rounds: a real PostgreSQL, Dask cluster and S3 of its own.

Each runs in processes that are started here and may be killed; see `benchmarks.crash`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Final

import pytest

from tests.dask_cluster import Cluster as DaskCluster
from tests.dask_cluster import dask_cluster
from tests.postgres import postgres_cluster
from tests.s3 import BUCKET, s3_server

BACKENDS: Final = ("postgres", "dask", "s3")
"""Backends that a server can use beside its folder."""

DASK_WORKERS: Final = 2


@dataclass
class Backends:
    """Backends that run beside the server.

    Attributes
    ----------
    environment
        Variables that a server needs to use it.
    faults
        Functions by name, each of which kills a part of a backend and restarts it.
    dask_workers
        Returns the process ids of the Dask workers, which run the worker processes of jobs.

    """

    environment: dict[str, str] = field(default_factory=dict)
    faults: dict[str, Callable[[], None]] = field(default_factory=dict)
    dask_workers: Callable[[], list[int]] = list


@contextmanager
def backends(names: Collection[str], folder: Path, draw: Random) -> Iterator[Backends]:
    """Run backends, each with its files in `folder`, until the context ends.

    Raises
    ------
    SystemExit
        When a backend is not installed.

    """
    found = Backends()
    with ExitStack() as running:
        try:
            if "postgres" in names:
                _add_postgres(found, running)
            if "s3" in names:
                _add_s3(found, running)
            # Started after S3: the cluster's machines find the bucket by this environment.
            if "dask" in names:
                _add_dask(found, running, folder, draw)
        except pytest.skip.Exception as error:
            raise SystemExit(str(error)) from error
        yield found


def _add_postgres(found: Backends, running: ExitStack) -> None:
    cluster = running.enter_context(postgres_cluster())

    def restart() -> None:
        cluster.stop()
        cluster.start()

    found.environment["OSG_DATABASE_URL"] = cluster.new_database()
    found.faults["PostgreSQL"] = restart


def _add_dask(found: Backends, running: ExitStack, folder: Path, draw: Random) -> None:
    cluster = running.enter_context(dask_cluster(folder, DASK_WORKERS))

    def restart_scheduler() -> None:
        cluster.restart_scheduler()
        # The workers end by themselves some seconds after they lose the scheduler.
        for process in cluster.workers:
            process.kill()
            process.wait()
        _fill(cluster)

    def replace_worker() -> None:
        process = draw.choice(cluster.workers)
        process.kill()
        process.wait()
        _fill(cluster)

    found.environment["OSG_EXECUTOR"] = f"dask://{cluster.address}"
    found.environment["OSG_WORKERS"] = str(DASK_WORKERS)
    found.faults["Dask scheduler"] = restart_scheduler
    found.faults["Dask worker"] = replace_worker
    found.dask_workers = lambda: [process.pid for process in cluster.workers]


def _fill(cluster: DaskCluster) -> None:
    """Replace workers that have ended, as the service manager of a cluster does."""
    cluster.workers[:] = [process for process in cluster.workers if process.poll() is None]
    while len(cluster.workers) < DASK_WORKERS:
        cluster.add_worker()


def _add_s3(found: Backends, running: ExitStack) -> None:
    # The address and the keys of the bucket come into the environment of this process.
    server = running.enter_context(s3_server(running.enter_context(pytest.MonkeyPatch.context())))

    def restart() -> None:
        server.stop()
        server.start()

    found.environment["OSG_STORAGE"] = f"s3://{BUCKET}/crash"
    found.faults["S3"] = restart
