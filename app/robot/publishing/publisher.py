"""Publisher: sends the robot's events to other programs in the network."""

from __future__ import annotations

from typing import Literal, Protocol

from app.recognition.errors import PublishError, explain_missing_package
from app.robot.events import Event

Network = Literal["dds"]
"""Networks to publish to: ``dds`` is DDS with the topic names of ROS 2."""


class Publisher(Protocol):
    """Protocol of publishers: send events to all subscribers."""

    def publish(self, event: Event) -> None:
        """Send one event."""

    def close(self) -> None:
        """Leave the network."""


def open_publisher(network: Network) -> Publisher:
    """Join a network and return its publisher.

    Raises
    ------
    PublishError
        When its library is not installed, or its settings are wrong.

    """
    with explain_missing_package(f"publishing over {network}", network, PublishError):
        from app.robot.publishing.dds import DdsPublisher
    return DdsPublisher()
