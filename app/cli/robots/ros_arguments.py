"""ROS arguments: splits a command line into the program's own arguments and those of ROS 2."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

BEGIN: Final = "--ros-args"
"""Starts the arguments of ROS 2."""

END: Final = "--"
"""Ends the arguments of ROS 2."""


def split_ros_arguments(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Split arguments into those of the program and those of ROS 2.

    Returns
    -------
    The program's arguments, and ROS 2's including each `BEGIN`; both in order.

    """
    own: list[str] = []
    ros: list[str] = []
    target = own
    for argument in arguments:
        if argument == BEGIN:
            target = ros
        if argument == END and target is ros:
            target = own
        else:
            target.append(argument)
    return own, ros
