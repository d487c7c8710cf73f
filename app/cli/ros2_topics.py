"""The topics of ``osg-studio robot --ros2``: what the robot sees and hears, told to ROS 2.

The nodes and their messages are ROS packages (`ros2/`), which pip does not install.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from typing import Protocol

from app.recognition.errors import OsgError
from app.recognition.estimation import FrameLandmarks
from app.robot import Event, Frame, SpokenLanguage


class Topics(Protocol):
    """Whoever tells a robot's other programs what its runtime sees and hears."""

    def look(self, frame: Frame, found: FrameLandmarks) -> None:
        """Tell what was found in a frame."""
        ...

    def hear(self, event: Event, language: SpokenLanguage) -> None:
        """Tell what happened, and the language that is listened for."""
        ...


def ros2_topics(arguments: Sequence[str]) -> AbstractContextManager[Topics]:
    """Return what publishes as a node of ROS 2 while it is entered.

    Parameters
    ----------
    arguments
        ROS 2's own, from ``--ros-args`` on: remapped names, parameters, the level of the log.

    Raises
    ------
    OsgError
        When ROS 2 or our packages are not in this environment.

    """
    try:
        from osg_ros.nodes.robot_node import published
    except ModuleNotFoundError as error:
        raise OsgError(
            f"--ros2 needs ROS 2 and the packages of the folder ros2/; {error.name} is missing: "
            "build them with colcon and source the workspace in this shell"
        ) from error
    return published(arguments)
