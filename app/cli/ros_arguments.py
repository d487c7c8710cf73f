"""ROS arguments of a command line, as every executable of ROS 2 takes them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

BEGIN: Final = "--ros-args"
"""What follows is ROS 2's."""

END: Final = "--"
"""What follows is the program's own again."""


def apart(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Part the arguments of a program from those of ROS 2.

    Returns
    -------
    The program's own, and ROS 2's with the `BEGIN` that introduces them; both in order.

    """
    own: list[str] = []
    ros: list[str] = []
    taken = own
    for argument in arguments:
        if argument == BEGIN:
            taken = ros
        if argument == END and taken is ros:
            taken = own
        else:
            taken.append(argument)
    return own, ros
