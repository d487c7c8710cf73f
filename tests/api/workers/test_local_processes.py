"""Worker processes on this machine, which behave alike whether forked or started anew."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from app.api.workers import local_processes
from app.api.workers.executor import TaskFiles
from app.api.workers.local_processes import LocalProcesses
from app.recognition.models.storage import DIRECTORY_VARIABLE
from tests.api.running import until
from tests.api.running_workers import alive, fork_servers_of, linux, workers_of
from tests.recognition.damaged_clips import write_clip

pytestmark = [pytest.mark.slow, linux]

PROBE_TWICE = """
import asyncio, sys
from pathlib import Path
from app.api.workers.executor import TaskFiles
from app.api.workers.local_processes import LocalProcesses

async def probe():
    files = TaskFiles((Path(sys.argv[1]),), ())
    async with LocalProcesses().start(["probe", "video", sys.argv[1]], files) as lines:
        while line := await lines.readline():
            print(line.decode())

for _ in range(2):
    asyncio.run(probe())
"""

CANCEL_AT_ONCE = """
from app.api.workers.forked_worker import _fork_server

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


async def answers(arguments: list[str], files: TaskFiles) -> list[dict[str, Any]]:
    """Run a worker to its end, and return its messages."""
    found = []
    async with LocalProcesses().start(arguments, files) as lines:
        while line := await lines.readline():
            found.append(json.loads(line))
    return found


async def probe(clip: Path) -> str:
    (answer,) = await answers(["probe", "video", str(clip)], TaskFiles((clip,), ()))
    return str(answer["kind"])


def record(clip: Path) -> tuple[list[str], TaskFiles]:
    """Return arguments and files of a worker that records a clip into files beside it."""
    made = tuple(clip.with_suffix(each) for each in (".npz", ".poster.jpg", ".strip.jpg"))
    return ["record", "video", str(clip), *map(str, (clip, *made))], TaskFiles((clip,), made)


@pytest.mark.usefixtures("way")
def test_a_worker_answers_and_ends(clip: Path) -> None:
    assert asyncio.run(probe(clip)) == "probed"


@pytest.mark.usefixtures("way")
def test_a_worker_is_ended_with_its_context(tmp_path: Path) -> None:
    clip = write_clip(tmp_path / "long.mp4", frames=2000)

    async def leave_early() -> int:
        async with LocalProcesses().start(*record(clip)) as lines:
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
    assert asyncio.run(answers(*record(clip)))[-1]["kind"] == "finished"
    monkeypatch.setenv(DIRECTORY_VARIABLE, str(clip.parent / "none"))
    assert asyncio.run(answers(*record(clip)))[-1]["code"] == "model_missing"


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
    command = [sys.executable, "-X", "dev", "-c", PROBE_TWICE, str(clip)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.count("probed") == 2
    assert done.stderr == ""


def test_jobs_that_are_cancelled_before_they_begin_end_without_a_word() -> None:
    command = [sys.executable, "-c", CANCEL_AT_ONCE]
    # Until every process that could write has ended.
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stderr == ""
