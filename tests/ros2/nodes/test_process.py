"""The process of a node: ends on a signal, and prints nothing that is no fault."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from app.robot import FrameRateChanged, OutputFailed
from osg_ros.nodes.robot_node import RobotNode
from tests.robot.languages import spoken
from tests.ros2 import workspace
from tests.ros2.nodes.bench import Bench

COMMAND_NODE = "from osg_ros.nodes.command_node import main; main()"


@pytest.mark.slow
def test_a_node_that_is_stopped_prints_no_exception(domain: int) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", COMMAND_NODE],
        env=workspace.environment(domain),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if "waiting for a gesture" in line:
                break
        process.send_signal(signal.SIGINT)
        rest = process.stdout.read()
    assert process.returncode == 0
    assert "exception" not in rest.lower()


def test_what_a_diver_must_know_is_a_problem_in_the_diagnostics(bench: Bench) -> None:
    node = bench.active(RobotNode)
    for event, words in (
        (FrameRateChanged(6.0, 2.0, False), "too slow for gestures: 2.0 frames a second"),
        (OutputFailed(7.0, "stdout", "No space left on device"), "No space left on device"),
    ):
        node.publish_event(event, spoken("circle"))
        assert node.health.report(1.0, 1.0, {}).status[0].message == words
    node.publish_event(FrameRateChanged(9.0, 5.0, True), spoken("circle"))
    assert "too slow" not in node.health.report(2.0, 1.0, {}).status[0].message
