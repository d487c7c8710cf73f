"""The topics of `osg-studio robot --ros2`, which has a camera of its own."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import rclpy
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Header

from app.recognition.errors import OsgError
from app.recognition.estimation import FrameLandmarks
from app.robot import Event, Frame, SourceOpened, SpokenLanguage
from osg_ros.nodes.managed_node import ManagedNode
from osg_ros.nodes.process import running, start
from osg_ros.topics.gesture_topics import GestureTopics
from osg_ros.topics.stamps import NANOSECONDS, Stopwatch

FRAME_ID = "camera"
"""Of the headers: the robot's own camera."""


class RobotNode(ManagedNode):
    """Publishes what a runtime that runs elsewhere in this process sees and tells."""

    def __init__(self, **options: Any) -> None:
        super().__init__("robot_node", (), "the camera", **options)
        self._topics: GestureTopics | None = None
        self._stopwatch: Stopwatch | None = None

    def prepare(self) -> None:
        """Make the publishers."""
        self._topics = GestureTopics(self)

    def begin(self) -> None:
        """Say that the camera is looked at."""
        if self._topics is not None:
            self._topics.recognitions.active(True)

    def halt(self) -> None:
        """Wait until the last recognition has arrived, and say that nothing is looked at."""
        if self._topics is not None:
            self._topics.recognitions.active(False)
            self._topics.recognitions.flush()

    def release(self) -> None:
        """Let go of the publishers."""
        self._topics = None

    def look(self, frame: Frame, found: FrameLandmarks) -> None:
        """Publish what was found in a frame."""
        if self._topics is not None and self._stopwatch is not None:
            stamp = self._stopwatch.stamp(frame.time)
            header = Header(stamp=stamp, frame_id=FRAME_ID)
            self._topics.look(header, frame, found)

    def hear(self, event: Event, language: SpokenLanguage) -> None:
        """Publish what happened.

        Stamps are when a camera's frame had arrived; those of a recording count from now.
        """
        if isinstance(event, SourceOpened):
            began = event.began
            now = self.get_clock().now().nanoseconds
            self._stopwatch = Stopwatch(round(began.timestamp() * NANOSECONDS) if began else now)
        if self._topics is not None:
            self._topics.hear(event, language, self._stopwatch, FRAME_ID)


@contextmanager
def published(arguments: Sequence[str]) -> Iterator[RobotNode]:
    """Give a node that publishes, whose services are answered in a thread of their own.

    Parameters
    ----------
    arguments
        ROS 2's own, from ``--ros-args`` on.

    Raises
    ------
    OsgError
        When ROS 2 does not understand an argument, or the node cannot be started.

    """
    try:
        rclpy.init(args=list(arguments), signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:
        raise OsgError(f"ROS 2 does not understand {' '.join(arguments)}: {error}") from error
    try:
        node = RobotNode()
        with running([node]) as executor:
            if not start(node):
                raise OsgError("the ROS 2 node did not start; its log says why")
            threading.Thread(target=executor.spin, name="ros", daemon=True).start()
            yield node
    finally:
        rclpy.try_shutdown()
