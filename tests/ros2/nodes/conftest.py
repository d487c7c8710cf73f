"""A ROS context per test, alone in its DDS domain; without ROS 2 these tests are left out."""

from __future__ import annotations

import fcntl
import random
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.ros2 import workspace

if workspace.missing() is None:
    workspace.source()
    import rclpy

    from tests.ros2.nodes.bench import Bench
else:
    # tests/ros2/test_workspace.py says why.
    collect_ignore_glob = ["test_*.py"]

LANGUAGE = Path(__file__).resolve().parents[3] / "languages" / "osg-table-1.json"

LAST_DOMAIN = 101
"""Domains whose ports lie below those that Linux gives to any program (ROS 2's documentation)."""


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Give a DDS domain of this machine alone, in which no other test is."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    # In any order: what a test that was killed has left behind may still speak in the first ones.
    for number in random.SystemRandom().sample(range(1, LAST_DOMAIN + 1), LAST_DOMAIN):
        with alone_in(number) as alone:
            if alone:
                yield number
                return
    pytest.fail(f"all {LAST_DOMAIN} DDS domains are taken by other tests")


@contextmanager
def alone_in(domain: int) -> Iterator[bool]:
    """Tell whether no test of this machine was in a DDS domain, and keep others out meanwhile."""
    folder = Path(tempfile.gettempdir()) / "osg-studio-test-domains"
    folder.mkdir(exist_ok=True)
    with (folder / str(domain)).open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            yield False
        else:
            yield True


@pytest.fixture
def bench(domain: int) -> Iterator[Bench]:
    """Give what runs nodes and listens to them; ROS is initialised meanwhile."""
    rclpy.init(domain_id=domain)
    bench = Bench()
    try:
        yield bench
    finally:
        bench.close()
        rclpy.try_shutdown()


@pytest.fixture(scope="session")
def language_file() -> Path:
    """Return a sample language: circle, wedge and three."""
    return LANGUAGE
