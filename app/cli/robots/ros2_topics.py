"""ROS 2 topics of ``osg-studio robot --ros2``: loads the node that publishes landmarks and events.

The node and its messages are ROS packages (`ros2/`), which pip does not install.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from typing import Protocol

from app.recognition.errors import OsgError
from app.recognition.estimation import FrameLandmarks
from app.robot import ActiveLanguage, Event, Frame


class Topics(Protocol):
    """Protocol of the node that publishes the robot's landmarks and events."""

    def publish_frame(self, frame: Frame, found: FrameLandmarks) -> None:
        """Publish the landmarks of a frame."""
        ...

    def publish_event(self, event: Event, language: ActiveLanguage) -> None:
        """Publish an event of the active language."""
        ...


def open_ros2_topics(arguments: Sequence[str]) -> AbstractContextManager[Topics]:
    """Return a context manager that runs a ROS 2 node and gives its topics.

    Parameters
    ----------
    arguments
        ROS 2's arguments, from ``--ros-args`` on: remapped names, parameters, log level.

    Raises
    ------
    OsgError
        When ROS 2 or this project's ROS packages are not installed.

    """
    try:
        from osg_ros.nodes.robot_node import run_robot_node
    except ModuleNotFoundError as error:
        raise OsgError(
            f"--ros2 needs ROS 2 and the packages of the folder ros2/; {error.name} is missing: "
            "build them with colcon and source the workspace in this shell"
        ) from error
    return run_robot_node(arguments)
