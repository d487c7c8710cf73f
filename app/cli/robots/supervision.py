"""Supervision: reports a robot's state to the service manager, by its events."""

from __future__ import annotations

from app.cli.robots.events import describe_event
from app.robot import Event, SourceEnded, SourceOpened
from app.system.service_manager import ServiceManager


def report_event(manager: ServiceManager, event: Event) -> None:
    """Report that the robot is ready, works or ends, with a description of its activity.

    A live source gives a heartbeat at least every 5 seconds, so a watchdog of 30 seconds restarts a
    robot that hangs.
    """
    match event:
        case SourceOpened():
            manager.tell_ready()
        case SourceEnded():
            manager.tell_stopping()
    manager.tell_alive()
    if sentence := describe_event(event):
        manager.tell_status(sentence)
