"""Robot node: publishes the topics of `osg-studio robot --ros2`, which reads its own camera."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import rclpy
from osg_interfaces.msg import Answer
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Header

from app.recognition.errors import OsgError
from app.recognition.poses.frame import FrameLandmarks
from app.robot import ActiveLanguage, AnswerGiven, Event, Frame, SourceOpened
from osg_ros.commands.replies import PULSE_SECONDS
from osg_ros.nodes.managed_node import RESULTS, ManagedNode
from osg_ros.nodes.process import LONGEST_WAIT, run_nodes, start_node
from osg_ros.topics.gesture_topics import GestureTopics
from osg_ros.topics.stamps import NANOSECONDS, Stopwatch

FRAME_ID = "camera"
"""Frame of the headers: the robot's own camera."""


class RobotNode(ManagedNode):
    """Node that publishes landmarks and events of a runtime in another thread of this process."""

    def __init__(self, **options: Any) -> None:
        super().__init__("robot_node", (), "the camera", **options)
        self._topics: GestureTopics | None = None
        self._answers: Any = None
        self._stopwatch: Stopwatch | None = None

    def prepare(self) -> None:
        """Create the publishers."""
        self._topics = GestureTopics(self)
        self._answers = self.add_publisher(Answer, "answer", RESULTS)

    def begin(self) -> None:
        """Publish that recognition is active."""
        if self._topics is not None:
            self._topics.recognitions.publish_active(True)

    def halt(self) -> None:
        """Publish that recognition is inactive, and wait until the last message has arrived."""
        if self._topics is not None:
            self._topics.recognitions.publish_active(False)
            self._topics.recognitions.flush()

    def release(self) -> None:
        """Drop the publishers."""
        self._topics = self._answers = None

    def publish_frame(self, frame: Frame, found: FrameLandmarks) -> None:
        """Publish the landmarks of a frame."""
        if self._topics is not None and self._stopwatch is not None:
            stamp = self._stopwatch.stamp(frame.time)
            header = Header(stamp=stamp, frame_id=FRAME_ID)
            self._topics.publish_frame(header, frame, found)

    def publish_event(self, event: Event, language: ActiveLanguage) -> None:
        """Publish an event.

        A camera's stamps are the arrival times of its frames; a recording's count from now.
        """
        if isinstance(event, SourceOpened):
            began = event.began
            now = self.get_clock().now().nanoseconds
            self._stopwatch = Stopwatch(round(began.timestamp() * NANOSECONDS) if began else now)
        if self._topics is None:
            return
        if isinstance(event, AnswerGiven) and self._stopwatch is not None:
            stamp = self._stopwatch.stamp(event.time)
            self._answers.publish(
                Answer(
                    header=Header(stamp=stamp, frame_id=FRAME_ID),
                    answer=event.answer.value,
                    pulses=event.pulses,
                    pulse_seconds=PULSE_SECONDS,
                    text=event.text,
                )
            )
        self._topics.publish_event(event, language, self._stopwatch, FRAME_ID)


@contextmanager
def run_robot_node(arguments: Sequence[str]) -> Iterator[RobotNode]:
    """Run a robot node while the context is open; a separate thread answers its services.

    Parameters
    ----------
    arguments
        ROS 2's arguments, from ``--ros-args`` on.

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
        with run_nodes([node]) as executor:
            if not start_node(node):
                raise OsgError("the ROS 2 node did not start; see its log")
            ending = threading.Event()

            def spin() -> None:
                while not ending.is_set():
                    executor.spin_once(timeout_sec=LONGEST_WAIT)

            thread = threading.Thread(target=spin, name="ros", daemon=True)
            thread.start()
            try:
                yield node
            finally:
                ending.set()
                thread.join()
    finally:
        rclpy.try_shutdown()
