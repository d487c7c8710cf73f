"""Nodes as a process: started, kept running, and shut down in order."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.lifecycle import TransitionCallbackReturn

from osg_ros.managed_node import ManagedNode

NOT_STARTED = 1
"""Exit code where a node that shall start by itself could not; the log says why."""


def start(node: ManagedNode) -> bool:
    """Configure and activate a node that shall start by itself.

    Returns
    -------
    Whether it is in the state that its parameter asks for.

    """
    if not node.settings["autostart"]:
        return True
    transitions = (node.trigger_configure, node.trigger_activate)
    return all(transition() == TransitionCallbackReturn.SUCCESS for transition in transitions)


@contextmanager
def running(nodes: Sequence[ManagedNode]) -> Iterator[MultiThreadedExecutor]:
    """Give an executor of the nodes; at the end they are shut down and destroyed."""
    # One thread per node and one for the services that must not wait for pictures.
    executor = MultiThreadedExecutor(num_threads=len(nodes) + 1)
    for node in nodes:
        executor.add_node(node)
    try:
        yield executor
    finally:
        executor.shutdown()
        for node in nodes:
            if rclpy.ok():
                node.trigger_shutdown()
            else:
                node.on_shutdown(None)
            node.destroy_node()


def spin(make: Callable[[], Sequence[ManagedNode]]) -> None:
    """Run nodes until the process is told to end; the main function of every executable.

    Parameters
    ----------
    make
        Makes the nodes once ROS is initialised.

    """
    rclpy.init()
    with running(make()) as executor:
        nodes: Sequence[ManagedNode] = executor.get_nodes()
        if not all([start(node) for node in nodes]):
            sys.exit(NOT_STARTED)
        with suppress(KeyboardInterrupt, ExternalShutdownException):
            executor.spin()
    rclpy.try_shutdown()
