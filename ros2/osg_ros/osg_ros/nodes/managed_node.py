"""Managed node: base class of all nodes, with life cycle, parameters and diagnostics."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from copy import copy
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.clock import Clock, ClockType
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.qos import (
    QoSDurabilityPolicy,
    QoSHistoryPolicy,
    QoSProfile,
    QoSReliabilityPolicy,
    qos_profile_sensor_data,
)
from rclpy.qos_overriding_options import QoSOverridingOptions

from osg_ros.diagnostics import Health
from osg_ros.parameters import Setting, Settings

SENSOR_DATA = qos_profile_sensor_data
"""For pictures and the results of each picture: best effort, so a lost message is not resent."""

NEWEST = QoSProfile(
    depth=1,
    history=QoSHistoryPolicy.KEEP_LAST,
    reliability=QoSReliabilityPolicy.BEST_EFFORT,
)
"""For pictures in a node that is slower than the camera: a longer queue would only add delay."""

RESULTS = QoSProfile(depth=10)
"""For recognitions and commands: reliable, with ten messages kept for a slow subscriber."""

LATCHED = QoSProfile(
    depth=1,
    history=QoSHistoryPolicy.KEEP_LAST,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.TRANSIENT_LOCAL,
)
"""For state and language: a late subscriber gets the last message."""

AUTOSTART = Setting(
    "autostart", True, "Configure and activate at start; false: wait for a lifecycle manager."
)
DIAGNOSTIC_PERIOD = Setting(
    "diagnostic_period", 1.0, "Seconds between two reports on /diagnostics.", 0.1, 60.0
)


class ManagedNode(LifecycleNode):  # type: ignore[misc]  # rclpy brings no types
    """Lifecycle node whose failed transitions log the reason in one line.

    Subclasses override `prepare`, `begin`, `halt` and `release`, which do nothing here. The reverse
    transition destroys what `add_publisher` and `add_subscription` created in a transition.

    Parameters
    ----------
    name
        Default name of the node.
    settings
        Parameters of the node.
    awaited
        Input topic, for diagnostics.
    steady
        Whether silence on that topic is a fault.
    **options
        Options of `rclpy.node.Node`.

    Attributes
    ----------
    settings
        All parameters.
    health
        Counts for diagnostics.
    finished
        Whether the node was shut down and cannot be used again.
    failure
        Why the process must end; empty while the node works.

    """

    def __init__(
        self,
        name: str,
        settings: Iterable[Setting],
        awaited: str,
        *,
        steady: bool = True,
        **options: Any,
    ) -> None:
        super().__init__(name, **options)
        self.settings = Settings(self, (AUTOSTART, DIAGNOSTIC_PERIOD, *settings))
        self.health = Health(self.get_fully_qualified_name(), awaited, steady=steady)
        self.finished = False
        self.failure = ""
        self._publishers_made: list[Any] = []
        self._subscriptions_made: list[Any] = []
        self._reported = time.monotonic()
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        # A steady clock, because the node's clock stops while a simulation or recording is paused.
        self._reporting = self.create_timer(
            self.settings["diagnostic_period"],
            self._report,
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )

    def prepare(self) -> None:
        """Read parameters, load files and models, create publishers.

        Raises
        ------
        ValueError, OSError
            When that fails; the message says what to change.

        """

    def begin(self) -> None:
        """Publish the first state and subscribe; the publishers are enabled."""

    def halt(self) -> None:
        """Stop what `begin` started; the publishers are still enabled."""

    def release(self) -> None:
        """Release what `prepare` acquired, also after it failed half way."""

    def watch(self) -> None:
        """Call `fail` if the node no longer works; called before every report."""

    def fail(self, reason: str) -> None:
        """Let the process end, so that its supervisor starts it again."""
        if not self.failure:
            self.failure = reason
            self.get_logger().fatal(f"{reason}; the process ends")

    def facts(self) -> Mapping[str, str]:
        """Return further keys and values for diagnostics."""
        return {}

    def add_publisher(self, kind: Any, topic: str, profile: QoSProfile) -> Any:
        """Create a publisher that is enabled in the active state and destroyed by cleanup."""
        made = self.create_lifecycle_publisher(
            kind,
            topic,
            copy(profile),  # the operator's overrides change it in place
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )
        self._publishers_made.append(made)
        return made

    def add_subscription(
        self, kind: Any, topic: str, callback: Callable[[Any], None], profile: QoSProfile
    ) -> None:
        """Subscribe until the node is deactivated."""
        self._subscriptions_made.append(
            self.create_subscription(
                kind,
                topic,
                callback,
                copy(profile),
                qos_overriding_options=QoSOverridingOptions.with_default_policies(),
            )
        )

    def count_input(self) -> None:
        """Count an input message."""
        self.health.count(time.monotonic())

    def report_problem(self, what: str) -> None:
        """Log a problem, at most once a second, and add it to the diagnostics."""
        self.health.problem(what)
        self.get_logger().error(what, throttle_duration_sec=1.0)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Prepare; stay unconfigured where that is not possible."""
        with self._log_faults():
            try:
                self.prepare()
            except (ValueError, OSError) as error:
                self.report_problem(" ".join(str(error).split()))
                self._release_all()
                return TransitionCallbackReturn.FAILURE
            return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Enable the publishers, then begin."""
        with self._log_faults():
            done = super().on_activate(state)
            self.health.listen(time.monotonic())
            self.begin()
            return done

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Halt, then disable the publishers."""
        with self._log_faults():
            self._stop()
            return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Release everything."""
        with self._log_faults():
            done = super().on_cleanup(state)
            self._release_all()
            return done

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop in any state of the node, and release everything."""
        with self._log_faults():
            self._stop()
            done = super().on_shutdown(state)
            self._release_all()
            self.finished = True
            return done

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Release everything; the node can be configured again."""
        with self._log_faults():
            self._stop()
            self._release_all()
            return TransitionCallbackReturn.SUCCESS

    @contextmanager
    def _log_faults(self) -> Iterator[None]:
        """Log an unexpected exception with its traceback; rclpy logs only that it failed."""
        try:
            yield
        except Exception:
            self.get_logger().fatal(traceback.format_exc())
            raise

    def _stop(self) -> None:
        self.health.listen(None)
        for made in self._subscriptions_made:
            self.destroy_subscription(made)
        self._subscriptions_made.clear()
        self.halt()

    def _release_all(self) -> None:
        self.release()
        for made in self._publishers_made:
            self.destroy_lifecycle_publisher(made)
        self._publishers_made.clear()

    def _report(self) -> None:
        self.watch()
        if self.failure:
            self.health.problem(self.failure)
        now = time.monotonic()
        seconds, self._reported = max(now - self._reported, 1e-3), now
        report = self.health.report(now, seconds, self.facts())
        report.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(report)
