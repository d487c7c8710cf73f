"""One process with the whole recogniser and the commands: what a robot usually runs."""

from __future__ import annotations

from osg_ros.command_node import CommandNode
from osg_ros.gesture_node import GestureNode
from osg_ros.spinning import spin


def main() -> None:
    """Run both nodes."""
    spin(lambda: [GestureNode(), CommandNode()])
