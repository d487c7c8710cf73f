"""What a robot without ROS 2 publishes is heard by the real rclpy in another process."""

from __future__ import annotations

import json
import subprocess
import sys
import time

import pytest
import rclpy
from osg_interfaces.msg import GestureRecognition
from std_msgs.msg import String

from app.robot import Listener, TakeRecognized, TakeRejected
from app.robot.messages import MESSAGES
from tests.api.recordings import recording_of
from tests.robot.languages import heard, spoken
from tests.ros2 import workspace
from tests.ros2.nodes.bench import PATIENCE, RELIABLE, Bench

pytest.importorskip("cyclonedds", reason="needs the extra dds")

ENOUGH = 6
"""Takes heard: two rounds of three."""


@pytest.mark.slow
def test_ros_hears_every_take_as_the_robot_heard_it(bench: Bench, domain: int) -> None:
    takes: list[GestureRecognition] = []
    labels: list[String] = []
    lines: list[String] = []
    for kind, topic, seen in (
        (GestureRecognition, "/osg/recognition", takes),
        (String, "/osg/recognized_gesture", labels),
        (String, "/osg/events", lines),
    ):
        bench.probe.create_subscription(kind, topic, seen.append, RELIABLE)
    robot = [sys.executable, "-m", "tests.robot.publishing_robot"]
    with subprocess.Popen(robot, env=workspace.environment(domain)) as process:
        try:
            end = time.monotonic() + PATIENCE
            while len(takes) < ENOUGH and time.monotonic() < end:
                rclpy.spin_once(bench.probe, timeout_sec=0.1)
        finally:
            process.kill()
    told = heard(Listener(spoken("circle")), recording_of("circle", "line"))
    expected = [event for event in told if isinstance(event, TakeRecognized | TakeRejected)]
    said = {(event.start, event.end): event for event in expected}
    assert len(takes) >= ENOUGH
    for take in takes:
        event = said[
            take.start.sec + take.start.nanosec / 1e9, take.end.sec + take.end.nanosec / 1e9
        ]
        assert take.rejected is isinstance(event, TakeRejected)
        assert take.label == ("" if isinstance(event, TakeRejected) else event.label)
        assert (take.nearest, take.confidence) == (event.nearest, event.confidence)
        assert (take.language_id, take.language_revision) == (event.sha256, event.revision)
        assert take.language_name == "pool"
        assert json.loads(take.report)["nearest"] == event.nearest
    recognised = {event.label for event in expected if isinstance(event, TakeRecognized)}
    assert {label.data for label in labels} == recognised
    kinds = {MESSAGES.validate_json(line.data).event for line in lines}
    assert kinds == {"language_changed", "state_changed", "take_recognized", "take_rejected"}
