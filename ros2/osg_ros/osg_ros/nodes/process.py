"""Node process: starts nodes, runs them, and shuts them down in order."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Final

import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.signals import SignalHandlerOptions

from osg_ros.nodes.managed_node import ManagedNode

NOT_STARTED = 1
"""Exit code when a node with autostart does not start; the log has the reason."""

FAILED = 3
"""Exit code when a node no longer works; a supervisor such as systemd restarts the process."""

LONGEST_WAIT: Final = 0.5
"""Longest delay until a signal is handled while no messages arrive, in seconds."""


class NodeExecutor(MultiThreadedExecutor):  # type: ignore[misc]  # rclpy brings no types
    """Executor that ends the callbacks in progress before it destroys what they use.

    rclpy's own destroys it first, and every such callback then prints an exception. Nobody may spin
    it any more.
    """

    def shutdown(self, timeout_sec: float | None = None, **options: Any) -> bool:
        """Wait for the callbacks, then shut down."""
        self._executor.shutdown(wait=True)
        return bool(super().shutdown(timeout_sec, **options))


def start_node(node: ManagedNode) -> bool:
    """Configure and activate a node whose parameter `autostart` is true.

    Returns
    -------
    Whether it is in the state that the parameter requires.

    """
    if not node.settings["autostart"]:
        return True
    transitions = (node.trigger_configure, node.trigger_activate)
    return all(transition() == TransitionCallbackReturn.SUCCESS for transition in transitions)


@contextmanager
def run_nodes(nodes: Sequence[ManagedNode]) -> Iterator[MultiThreadedExecutor]:
    """Run nodes in an executor; at the end shut them down and destroy them."""
    # One thread per node, and one for services, which must not wait for pictures.
    executor = NodeExecutor(num_threads=len(nodes) + 1)
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
def catch_stop_signals() -> Iterator[threading.Event]:
    """Return an event that SIGINT and SIGTERM set.

    ROS's own handlers would destroy the topics before a node can publish that it is inactive.
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
    """Run nodes until SIGINT, SIGTERM or the failure of one; the main function of every executable.

    Parameters
    ----------
    make
        Creates the nodes once ROS is initialised.

    """
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        nodes = make()
        with catch_stop_signals() as ending, run_nodes(nodes) as executor:
            # A list, so that every node logs its problem and not only the first one.
            if not all([start_node(node) for node in nodes]):
                sys.exit(NOT_STARTED)
            while not ending.is_set():
                executor.spin_once(timeout_sec=LONGEST_WAIT)
                if any(node.failure for node in nodes):
                    sys.exit(FAILED)
    finally:
        rclpy.try_shutdown()
