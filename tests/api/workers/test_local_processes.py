"""Worker processes on this machine, which behave alike whether forked or started anew."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.api.workers import local_processes
from app.api.workers.executor import Order, TaskFiles
from app.api.workers.local_processes import LocalProcesses, memory_of
from app.api.workers.tasks import AnyTask, Probe, Record
from app.recognition.models.storage import DIRECTORY_VARIABLE
from tests.api.running import until
from tests.api.running_workers import alive, fork_servers_of, linux, workers_of
from tests.recognition.damaged_clips import write_clip

pytestmark = [pytest.mark.slow, linux]

PROBE_TWICE = """
import asyncio, sys
from pathlib import Path
from app.api.workers.local_processes import LocalProcesses
from app.api.workers.executor import Order, TaskFiles

order = Order(sys.argv[1], TaskFiles((Path(sys.argv[2]),)), Path("/nowhere"))

async def probe():
    async with LocalProcesses().start(order) as lines:
        while line := await lines.readline():
            print(line.decode())

for _ in range(2):
    asyncio.run(probe(), debug=False)  # Else a slow machine's callbacks are told.
"""

CANCEL_AT_ONCE = """
from app.api.workers.local_processes import _fork_server

for _ in range(20):
    _fork_server.connect().close()
"""


@pytest.fixture(params=["forked", "started"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Run a test with forked workers, and with workers started as where forking is impossible."""
    way = str(request.param)
    monkeypatch.setattr(local_processes, "can_fork", lambda: way == "forked")
    return way


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    return write_clip(tmp_path / "clip.mp4")


async def answers(task: AnyTask, files: TaskFiles | None = None) -> list[dict[str, Any]]:
    """Run a worker to its end, with rights to other files or its own; return its messages."""
    found = []
    given = order(task) if files is None else replace(order(task), files=files)
    async with LocalProcesses().start(given) as lines:
        while line := await lines.readline():
            found.append(json.loads(line))
    return found


def order(task: AnyTask) -> Order:
    """Return an order without limits, which unpacks nothing."""
    return Order(task.model_dump_json(), task.files, Path("/nowhere"))


async def probe(clip: Path) -> str:
    (answer,) = await answers(Probe(source="video", file=clip))
    return str(answer["kind"])


def record(clip: Path, folder: Path | None = None) -> Record:
    """Return the task that records a clip into files beside it, or in another folder."""
    place = (folder or clip.parent) / clip.name
    made = [place.with_suffix(each) for each in (".npz", ".poster.jpg", ".strip.jpg")]
    recording, poster, filmstrip = made
    return Record(
        source="video", file=clip, recording=recording, poster=poster, filmstrip=filmstrip
    )


@pytest.mark.usefixtures("way")
def test_a_worker_answers_and_ends(clip: Path) -> None:
    assert asyncio.run(probe(clip)) == "probed"


@pytest.mark.usefixtures("way")
def test_a_worker_is_ended_with_its_context(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "long.mp4", frames=2000)

    async def leave_early() -> int:
        async with LocalProcesses().start(order(record(clip))) as lines:
            await lines.readline()
            (worker,) = workers_of(os.getpid())
            os.kill(worker, signal.SIGSTOP)
        return worker

    assert not alive(asyncio.run(leave_early()))
    assert not clip.with_suffix(".npz").exists()


@pytest.mark.usefixtures("way", "installed_models")
def test_a_worker_has_the_environment_of_the_moment(
    clip: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert asyncio.run(answers(record(clip)))[-1]["kind"] == "finished"
    monkeypatch.setenv(DIRECTORY_VARIABLE, str(clip.parent / "none"))
    assert asyncio.run(answers(record(clip)))[-1]["code"] == "model_missing"


def test_many_workers_begin_at_once(clip: Path) -> None:
    async def probe_all() -> list[str]:
        return await asyncio.gather(*(probe(clip) for _ in range(20)))

    assert asyncio.run(probe_all()) == ["probed"] * 20


def test_a_fork_server_that_was_killed_is_started_again(clip: Path) -> None:
    assert asyncio.run(probe(clip)) == "probed"
    (killed,) = fork_servers_of(os.getpid())
    os.kill(killed, signal.SIGKILL)
    # A worker requested while the fork server dies is started anew.
    assert asyncio.run(probe(clip)) == "probed"
    until(lambda: not alive(killed))
    assert asyncio.run(probe(clip)) == "probed"
    (server,) = fork_servers_of(os.getpid())
    assert server != killed


def test_the_process_that_is_forked_has_one_thread(clip: Path) -> None:
    assert asyncio.run(probe(clip)) == "probed"
    (server,) = fork_servers_of(os.getpid())
    assert len(list(Path(f"/proc/{server}/task").iterdir())) == 1


def test_processes_end_without_a_word(clip: Path) -> None:
    probing = Probe(source="video", file=clip).model_dump_json()
    command = [sys.executable, "-X", "dev", "-c", PROBE_TWICE, probing, str(clip)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.count("probed") == 2
    assert done.stderr == ""


def test_jobs_that_are_cancelled_before_they_begin_end_without_a_word() -> None:
    command = [sys.executable, "-c", CANCEL_AT_ONCE]
    # Until every process that could write has ended.
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stderr == ""


@pytest.mark.usefixtures("way", "installed_models")
def test_of_processes_that_hold_too_much_together_the_largest_is_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(local_processes, "LOOK_SECONDS", 0.01)
    clip = write_clip(tmp_path / "long.mp4", frames=2000)

    async def hold() -> None:
        processes = LocalProcesses(2**62)
        async with processes.start(order(record(clip))) as large:
            while b'"done":0' in await large.readline():
                pass
            async with processes.start(order(record(clip, tmp_path))) as small:
                _, other = processes._running
                os.kill(other.process, signal.SIGSTOP)
                processes._most = sum(memory_of(each.process) for each in processes._running) - 1
                while await large.readline():
                    pass
                assert memory_of(other.process) > 0
                del small

    asyncio.run(hold())
