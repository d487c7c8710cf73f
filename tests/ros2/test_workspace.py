"""The message packages build with ROS 2's own generators; a skip states what is missing here."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.ros2 import workspace


def test_another_process_imports_what_was_built() -> None:
    if (reason := workspace.missing()) is not None:
        pytest.skip(f"{reason}; so the tests in tests/ros2/nodes are left out")
    ran = subprocess.run(
        [
            sys.executable,
            "-c",
            "from osg_interfaces.msg import Keypoint; print(Keypoint(name='nose', x=1.5))",
        ],
        env=workspace.environment(1),
        capture_output=True,
        text=True,
        check=True,
    )
    assert "Keypoint(name='nose', x=1.5, y=0.0, confidence=0.0)" in ran.stdout
