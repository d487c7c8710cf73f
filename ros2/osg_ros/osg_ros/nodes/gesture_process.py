"""Gesture process: runs the gesture node and the command node in one process, the usual setup."""

from __future__ import annotations

from osg_ros.nodes.command_node import CommandNode
from osg_ros.nodes.gesture_node import GestureNode
from osg_ros.nodes.process import spin


def main() -> None:
    """Run both nodes."""
    spin(lambda: [GestureNode(), CommandNode()])
