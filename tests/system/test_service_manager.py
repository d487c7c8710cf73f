"""The service manager hears on a real socket that a service is ready, works, and ends."""

from __future__ import annotations

import os
import secrets
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from app.cli.robots.robot import report_event
from app.robot import Heartbeat, SourceEnded, SourceLost, SourceOpened
from app.system.service_manager import ServiceManager
from tests.command_line import OsgStudio
from tests.conftest import ROOT
from tests.recognition.damaged_clips import write_clip
from tests.robot.languages import language_of
from tests.service_socket import ServiceSocket, managing

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there is no such socket")


def test_a_robot_tells_what_it_does(tmp_path: Path) -> None:
    with managing(tmp_path) as (channel, variables):
        manager = ServiceManager(variables)
        report_event(manager, SourceOpened(0.0, "camera 0", True, (640, 480), None))
        assert channel.read() == [
            "READY=1",
            "WATCHDOG=1",
            "STATUS=watching camera 0, 640 x 480 pixels",
        ]
        report_event(manager, SourceLost(1.0, "unplugged"))
        report_event(manager, Heartbeat(5.0, 10, 0, True))
        (status,) = channel.read()
        assert status.startswith("STATUS=source lost: unplugged")
        report_event(manager, SourceEnded(9.0, 10, 0, True))
        assert channel.read() == ["STOPPING=1"]


def test_signs_of_life_come_twice_in_the_watchdogs_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    times = iter((100.0, 101.0, 114.9, 115.0, 129.0, 130.0))
    monkeypatch.setattr(time, "monotonic", lambda: next(times))
    with managing(tmp_path) as (channel, variables):
        manager = ServiceManager(variables)
        for _ in range(6):
            manager.tell_alive()
        assert channel.read() == ["WATCHDOG=1"] * 3


@pytest.mark.parametrize("other", [{"WATCHDOG_USEC": ""}, {"WATCHDOG_PID": "1"}])
def test_without_a_watchdog_of_this_process_there_are_none(
    tmp_path: Path, other: dict[str, str]
) -> None:
    with managing(tmp_path) as (channel, variables):
        ServiceManager(variables | other).tell_alive()
        assert channel.read() == []


def test_without_a_manager_or_when_it_is_gone_nothing_happens(tmp_path: Path) -> None:
    ServiceManager({}).tell_ready()
    with managing(tmp_path) as (channel, variables):
        manager = ServiceManager(variables)
        channel.close()
        manager.tell_ready()


@pytest.mark.skipif(sys.platform != "linux", reason="abstract addresses are Linux's")
def test_an_abstract_address_is_understood() -> None:
    name = f"osg-{secrets.token_hex(8)}"
    channel = ServiceSocket("\0" + name)
    ServiceManager({"NOTIFY_SOCKET": f"@{name}"}).tell_ready()
    assert channel.read() == ["READY=1"]
    channel.close()


@pytest.mark.usefixtures("installed_models")
def test_the_robot_command_tells_it(
    osg_studio: OsgStudio, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    language_of("circle").save(tmp_path / "pool.json")
    clip = write_clip(tmp_path / "dive.mp4", frames=2)
    with managing(tmp_path) as (channel, variables):
        for name, value in variables.items():
            monkeypatch.setenv(name, value)
        osg_studio("robot", "--language", tmp_path / "pool.json", "--source", clip)
        lines = channel.read()
    assert lines[0] == "READY=1"
    assert "WATCHDOG=1" in lines
    assert lines[-1] == "STOPPING=1"


@pytest.mark.slow
def test_the_studio_tells_it(tmp_path: Path) -> None:
    with managing(tmp_path) as (channel, variables):
        serve = ["serve", "--port", "0", "--no-browser", "--data-dir", str(tmp_path / "data")]
        process = subprocess.Popen(
            [sys.executable, "-m", "app", *serve],
            cwd=ROOT,
            env={**os.environ, **variables, "WATCHDOG_USEC": "200000"},
            stdout=subprocess.DEVNULL,
        )
        try:
            channel.wait_for("READY=1")
            assert channel.wait().startswith("STATUS=at http://127.0.0.1:")
            channel.wait_for("WATCHDOG=1")
            channel.wait_for("WATCHDOG=1")
            process.send_signal(signal.SIGTERM)
            channel.wait_for("STOPPING=1")
            assert process.wait(60) in (0, -signal.SIGTERM)  # uvicorn passes the signal on
        finally:
            process.kill()
            process.wait()
