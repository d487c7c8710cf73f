"""Nodes under test, and a probe node that publishes and subscribes beside them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.parameter import Parameter
from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy

from osg_ros.nodes.managed_node import ManagedNode

PATIENCE = 180.0
"""Longest wait for a message in seconds; only a failing test takes so long."""

RELIABLE = QoSProfile(depth=1000, reliability=QoSReliabilityPolicy.RELIABLE)
BEST_EFFORT = QoSProfile(depth=1000, reliability=QoSReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(
    depth=1000,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.TRANSIENT_LOCAL,
)


class Bench:
    """Runs nodes in this process, callback by callback.

    Attributes
    ----------
    probe
        The node that publishes and subscribes.
    nodes
        Those under test, in the order in which they were added.

    """

    def __init__(self) -> None:
        self._executor = SingleThreadedExecutor()
        self.nodes: list[ManagedNode] = []
        self.probe = rclpy.create_node("probe")
        self._executor.add_node(self.probe)

    def add(
        self,
        kind: Callable[..., ManagedNode],
        *,
        namespace: str = "",
        arguments: Sequence[str] = (),
        **parameters: Any,
    ) -> Any:
        """Make a node with parameters and ROS arguments, unconfigured."""
        given = [Parameter(name, value=value) for name, value in parameters.items()]
        node = kind(
            parameter_overrides=given, namespace=namespace, cli_args=list(arguments) or None
        )
        self.nodes.append(node)
        self._executor.add_node(node)
        return node

    def active(self, kind: Callable[..., ManagedNode], **options: Any) -> Any:
        """Make a node as `add` does, and activate it."""
        node = self.add(kind, **options)
        assert node.trigger_configure() == TransitionCallbackReturn.SUCCESS
        assert node.trigger_activate() == TransitionCallbackReturn.SUCCESS
        return node

    def subscribe(self, kind: Any, topic: str, profile: QoSProfile = RELIABLE) -> list[Any]:
        """Return the list that the messages of a topic go to from now on."""
        messages: list[Any] = []
        self.probe.create_subscription(kind, topic, messages.append, profile)
        return messages

    def speaker(self, kind: Any, topic: str, profile: QoSProfile = RELIABLE) -> Any:
        """Return a publisher, once somebody listens to it."""
        publisher = self.probe.create_publisher(kind, topic, profile)
        self.wait(lambda: publisher.get_subscription_count() > 0, f"a subscription to {topic}")
        return publisher

    def wait(self, condition: Callable[[], bool], what: str) -> None:
        """Run the nodes until a condition holds."""
        assert self.comes(condition, PATIENCE), f"no {what} within {PATIENCE:g} s"

    def comes(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Run the nodes until a condition holds, or that long; tell whether it holds."""
        end = time.monotonic() + seconds
        while not condition() and time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.02)
        return condition()

    def ask(self, kind: Any, service: str, request: Any) -> Any:
        """Call a service and return its response."""
        client = self.probe.create_client(kind, service)
        self.wait(client.service_is_ready, f"service {service}")
        future = client.call_async(request)
        self.wait(future.done, f"response of {service}")
        return future.result()

    def close(self) -> None:
        """Shut down and destroy the nodes."""
        self._executor.shutdown()
        for node in self.nodes:
            if not node.finished:
                node.trigger_shutdown()
            node.destroy_node()
        self.probe.destroy_node()


def state_of(node: ManagedNode) -> int:
    """Return the node's primary state."""
    return int(node._state_machine.current_state[0])
