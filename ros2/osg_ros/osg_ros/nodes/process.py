"""Nodes as a process: started, kept running, and shut down in order."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Final

import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.signals import SignalHandlerOptions

from osg_ros.nodes.managed_node import ManagedNode

NOT_STARTED = 1
"""Exit code where a node that shall start by itself could not; the log says why."""

LONGEST_WAIT: Final = 0.5
"""Seconds until a signal is noticed while nothing happens."""


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
            if not node.finished:
                node.trigger_shutdown()
            node.destroy_node()


@contextmanager
def told_to_end() -> Iterator[threading.Event]:
    """Give what is set by SIGINT and SIGTERM.

    ROS's own handlers would take the topics away before a node could say that it is inactive.
    """
    ending = threading.Event()
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = {number: signal.getsignal(number) for number in numbers}
    for number in numbers:
        signal.signal(number, lambda *_: ending.set())
    try:
        yield ending
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def spin(make: Callable[[], Sequence[ManagedNode]]) -> None:
    """Run nodes until the process is told to end; the main function of every executable.

    Parameters
    ----------
    make
        Makes the nodes once ROS is initialised.

    """
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        nodes = make()
        with told_to_end() as ending, running(nodes) as executor:
            # A list: every node shall say what it lacks, not only the first.
            if not all([start(node) for node in nodes]):
                sys.exit(NOT_STARTED)
            while not ending.is_set():
                executor.spin_once(timeout_sec=LONGEST_WAIT)
    finally:
        rclpy.try_shutdown()
