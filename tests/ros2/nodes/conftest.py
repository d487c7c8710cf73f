"""A ROS context per test, alone in its DDS domain; without ROS 2 these tests are left out."""

from __future__ import annotations

import random
from collections.abc import Iterator
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
"""Domains whose ports lie below those that Linux gives to whoever asks (ROS 2's documentation)."""


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> int:
    """Return a DDS domain of this machine alone, most likely used by nobody else now."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    return random.SystemRandom().randint(1, LAST_DOMAIN)


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
