"""What all nodes share: a life cycle that refuses in words, parameters, and diagnostics."""

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
"""Pictures and what is computed from each: the newest counts, a lost one is not sent again."""

NEWEST = QoSProfile(
    depth=1,
    history=QoSHistoryPolicy.KEEP_LAST,
    reliability=QoSReliabilityPolicy.BEST_EFFORT,
)
"""Pictures for whoever takes longer than from one to the next: a queue would only be a delay."""

RESULTS = QoSProfile(depth=10)
"""Recognitions and commands: reliable, a few are kept while a subscriber is slow."""

LATCHED = QoSProfile(
    depth=1,
    history=QoSHistoryPolicy.KEEP_LAST,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.TRANSIENT_LOCAL,
)
"""State and language: whoever comes later still gets the last one."""

AUTOSTART = Setting(
    "autostart", True, "Configure and activate at start; false: wait for a lifecycle manager."
)
DIAGNOSTIC_PERIOD = Setting(
    "diagnostic_period", 1.0, "Seconds between two reports on /diagnostics.", 0.1, 60.0
)


class ManagedNode(LifecycleNode):  # type: ignore[misc]  # rclpy brings no types
    """A lifecycle node whose transitions fail with one line that says why.

    What a node does is in four methods that do nothing here: `prepare`, `begin`, `halt` and
    `release`. Publishers and subscriptions made by `publisher` and `subscription` go with the
    transition that undoes the one they were made in.

    Parameters
    ----------
    name
        The node's default name.
    settings
        Its own parameters.
    awaited
        The topic it works on, for diagnostics.
    steady
        Whether something is wrong when nothing comes on it.
    **options
        For `rclpy.node.Node`.

    Attributes
    ----------
    settings
        All parameters.
    health
        What diagnostics tell.
    finished
        Whether it was shut down and cannot be used again.

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
        self._publishers_made: list[Any] = []
        self._subscriptions_made: list[Any] = []
        self._reported = time.monotonic()
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        # Not the node's clock, which stands still while a simulation or a recording is paused.
        self._reporting = self.create_timer(
            self.settings["diagnostic_period"],
            self._report,
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )

    def prepare(self) -> None:
        """Read parameters, load files and models, make publishers.

        Raises
        ------
        ValueError, OSError
            When that cannot be done; the message says what to change.

        """

    def begin(self) -> None:
        """Publish what is known at once, and subscribe; publishers are enabled."""

    def halt(self) -> None:
        """Stop what `begin` began; publishers are still enabled."""

    def release(self) -> None:
        """Let go of what `prepare` took; it may have failed half way."""

    def facts(self) -> Mapping[str, str]:
        """Return what else diagnostics shall tell."""
        return {}

    def publisher(self, kind: Any, topic: str, profile: QoSProfile) -> Any:
        """Make a publisher that speaks while the node is active, and goes when it is cleaned up."""
        made = self.create_lifecycle_publisher(
            kind,
            topic,
            copy(profile),  # an operator's overrides are written into it
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )
        self._publishers_made.append(made)
        return made

    def subscription(
        self, kind: Any, topic: str, heard: Callable[[Any], None], profile: QoSProfile
    ) -> None:
        """Subscribe until the node is deactivated."""
        self._subscriptions_made.append(
            self.create_subscription(
                kind,
                topic,
                heard,
                copy(profile),
                qos_overriding_options=QoSOverridingOptions.with_default_policies(),
            )
        )

    def count_input(self) -> None:
        """Count a message that the node worked on."""
        self.health.count(time.monotonic())

    def complain(self, what: str) -> None:
        """Log a problem at most once a second, and tell diagnostics."""
        self.health.problem(what)
        self.get_logger().error(what, throttle_duration_sec=1.0)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Prepare; stay unconfigured where that is not possible."""
        with self._faults_told():
            try:
                self.prepare()
            except (ValueError, OSError) as error:
                self.complain(" ".join(str(error).split()))
                self._let_go()
                return TransitionCallbackReturn.FAILURE
            return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Enable the publishers, then begin."""
        with self._faults_told():
            done = super().on_activate(state)
            self.health.listen(time.monotonic())
            self.begin()
            return done

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Halt, then disable the publishers."""
        with self._faults_told():
            self._stop()
            return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Release everything."""
        with self._faults_told():
            done = super().on_cleanup(state)
            self._let_go()
            return done

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop in whatever state the node is, and release everything."""
        with self._faults_told():
            self._stop()
            done = super().on_shutdown(state)
            self._let_go()
            self.finished = True
            return done

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Release everything; the node can be configured again."""
        with self._faults_told():
            self._stop()
            self._let_go()
            return TransitionCallbackReturn.SUCCESS

    @contextmanager
    def _faults_told(self) -> Iterator[None]:
        """Log what a transition did not expect; rclpy would only say that it failed."""
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

    def _let_go(self) -> None:
        self.release()
        for made in self._publishers_made:
            self.destroy_lifecycle_publisher(made)
        self._publishers_made.clear()

    def _report(self) -> None:
        now = time.monotonic()
        seconds, self._reported = max(now - self._reported, 1e-3), now
        report = self.health.report(now, seconds, self.facts())
        report.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(report)
