"""Jobs on a real Dask cluster: each takes effect exactly once, whatever is killed."""

from __future__ import annotations

import asyncio
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from distributed import Client, Event

from app.api.services.running_studio import Studio
from app.api.workers.dask_cluster import DaskCluster
from app.api.workers.executor import Order
from app.recognition import Recording
from app.settings import Settings
from app.store import Job
from tests.api.recordings import add_recorded_clip, recording_of
from tests.api.routes.clips.test_clips import upload
from tests.api.running import Running, until
from tests.api.running_workers import linux, workers_of
from tests.api.workers.test_local_processes import order, record
from tests.dask_cluster import Cluster, dask_cluster
from tests.recognition.damaged_clips import write_clip
from tests.recognition.demonstrations import pool
from tests.recognition.strategies import circle, line

pytestmark = [pytest.mark.slow, linux, pytest.mark.usefixtures("installed_models")]

JOBS = "/api/v1/jobs"
FRAMES = 20
SILENCE = 10.0
"""Seconds without a line after which a process is taken for a hanging one."""


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with dask_cluster(tmp_path_factory.mktemp("dask")) as cluster:
        yield cluster


@pytest.fixture
def settings(tmp_path: Path, cluster: Cluster) -> Settings:
    return Settings(
        data_dir=tmp_path / "data",
        samples_dir=tmp_path / "none",
        executor=f"dask://{cluster.address}",
        workers=2,
    )


def workers_at_work(cluster: Cluster, command: str = "record") -> dict[int, int]:
    """Return the worker processes that run `command`, with their Dask workers."""
    return {child: dask.pid for dask in cluster.workers for child in workers_of(dask.pid, command)}


def status(client: httpx.Client, job_id: str) -> str:
    return str(client.get(f"{JOBS}/{job_id}").json()["status"])


def ended(client: httpx.Client, server: Running, job_id: str) -> Job:
    """Return a job once it is done or has failed."""
    until(lambda: status(client, job_id) in ("done", "failed"))
    return server.studio.jobs.get(job_id)


def test_jobs_run_on_the_cluster_and_checks_and_test_runs_too(
    client: httpx.Client, studio: Studio, cluster: Cluster, tmp_path: Path
) -> None:
    clip = write_clip(tmp_path / "clip.mp4", frames=FRAMES)
    with Client(cluster.address, set_as_default=False) as dask:
        until(lambda: len(dask.nthreads()) == 2)
    jobs = [upload(client, clip).json()["job_id"] for _ in range(2)]
    machines = set[int]()

    def were_both_at_work() -> bool:
        # On a loaded machine one is done before the other one has begun.
        machines.update(workers_at_work(cluster).values())
        return len(machines) == 2

    until(were_both_at_work)
    assert workers_of(os.getpid()) == []
    until(lambda: all(status(client, job) == "done" for job in jobs))
    assert client.get(f"{JOBS}/{jobs[0]}").json()["done"] == FRAMES
    content = pool(circle=circle, line=line).to_json()
    language = client.post("/api/v1/languages/import", content=content).json()["id"]
    assert client.get(f"/api/v1/languages/{language}/check").status_code == 200
    shown = add_recorded_clip(studio, recording_of("circle", "line"))
    takes = f"/api/v1/languages/{language}/test-set"
    client.post(takes, json={"takes": [{"clip_id": shown, "expected": "circle"}]})
    assert client.post(f"{takes}/run").json()["overall"]["asked"] == 2


def test_a_cancelled_job_ends_where_it_runs(
    client: httpx.Client, cluster: Cluster, tmp_path: Path
) -> None:
    job = upload(client, write_clip(tmp_path / "long.mp4", frames=2000)).json()["job_id"]
    until(lambda: workers_at_work(cluster))
    client.delete(f"{JOBS}/{job}")
    until(lambda: not workers_at_work(cluster))
    assert status(client, job) == "cancelled"


def test_a_job_whose_machine_vanishes_is_done_by_another_one_once(
    client: httpx.Client, server: Running, cluster: Cluster, tmp_path: Path
) -> None:
    job = upload(client, write_clip(tmp_path / "clip.mp4", frames=FRAMES)).json()["job_id"]
    until(lambda: workers_at_work(cluster))
    (child, machine) = next(iter(workers_at_work(cluster).items()))
    cluster.add_worker()
    for process in (machine, child):
        os.kill(process, signal.SIGKILL)
    answer = ended(client, server, job)
    assert (answer.error, answer.status, answer.attempts) == (None, "done", 1)
    assert answer.frames == FRAMES
    recording = server.studio.clips.recording(answer.clip_id)
    assert len(Recording.load(recording).poses) == FRAMES
    assert not list(recording.parent.glob(".*"))


def test_a_job_that_waits_for_a_place_again_is_not_taken_for_a_hanging_one(
    cluster: Cluster, tmp_path: Path
) -> None:
    clip = write_clip(tmp_path / "long.mp4", frames=2000)
    asyncio.run(lose_its_place(cluster, order(record(clip))))
    cluster.add_worker()  # in place of the killed one


async def lose_its_place(cluster: Cluster, given: Order) -> None:
    """Kill the machine of a process while all others are taken, and give it one of them later."""
    executor = DaskCluster(cluster.address)
    async with (
        executor.start(given) as lines,
        Client(cluster.address, asynchronous=True, set_as_default=False) as dask,
    ):
        await lines.readline()
        (child, machine) = next(iter(workers_at_work(cluster).items()))
        processes = await dask.run(os.getpid)
        lost = next(address for address, process in processes.items() if process == machine)
        others = set(processes) - {lost}
        free = await Event("free", client=dask)
        taken = [dask.submit(free.wait, workers=[each], pure=False) for each in others]
        while sum(map(len, (await dask.processing()).values())) <= len(others):
            await asyncio.sleep(0.1)
        for process in (machine, child):
            os.kill(process, signal.SIGKILL)
        while lost in await dask.nthreads():
            await asyncio.sleep(0.1)
        waits = asyncio.ensure_future(lines.readline(SILENCE))
        while (await asyncio.wait({waits}, timeout=1.5 * SILENCE))[0]:
            assert waits.result()  # told before the machine was killed
            waits = asyncio.ensure_future(lines.readline(SILENCE))
        waits.cancel()
        await free.set()
        await dask.gather(taken)
        assert await lines.readline()
    await executor.close()


def test_a_job_whose_scheduler_vanishes_is_submitted_again(
    client: httpx.Client, server: Running, cluster: Cluster, tmp_path: Path
) -> None:
    job = upload(client, write_clip(tmp_path / "clip.mp4", frames=FRAMES)).json()["job_id"]
    until(lambda: workers_at_work(cluster))
    cluster.restart_scheduler()
    cluster.add_worker()  # a worker ends when its scheduler does not come back
    answer = ended(client, server, job)
    assert (answer.error, answer.status, answer.attempts) == (None, "done", 1)
