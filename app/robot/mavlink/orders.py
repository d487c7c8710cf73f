"""Vehicle orders: sends the steps of one mission until each is proven done, without a network.

There is no queue: a newer mission replaces the active one, so that no action is done long after its
request.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink.actions import OUR_COMPONENT, Message, Reported, Step
from app.robot.mavlink.table import Vehicle

EMERGENCY_SECONDS: Final = 60.0
"""Seconds for which an emergency is repeated; after that the vehicle has another pilot or is
lost."""

REBOOT_MS: Final = 1000
"""Milliseconds by which packets out of order may set back the vehicle's time since boot."""

GO_ON: Final = (
    mavlink.MAV_RESULT_ACCEPTED,
    mavlink.MAV_RESULT_IN_PROGRESS,
    mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
)
"""Results after which a command is repeated until it is done; all others refuse it."""

OutcomeKind = Literal["done", "refused", "unanswered", "replaced"]


@dataclass(frozen=True)
class Order:
    """A mission for the vehicle.

    Attributes
    ----------
    words
        Description for people.
    steps
        Requests to the vehicle, in order.
    emergency
        Whether the order is repeated even after a refusal.

    """

    words: str
    steps: tuple[Step, ...]
    emergency: bool = False


@dataclass(frozen=True)
class Outcome:
    """How an order ended.

    Attributes
    ----------
    order
        The order.
    kind
        ``done``: proven by the vehicle. ``refused``: by the vehicle. ``unanswered``: not proven in
        time. ``replaced``: by a newer order.
    answer
        Result of a refusal, such as ``DENIED``.

    """

    order: Order
    kind: OutcomeKind
    answer: str = ""


class OrderDesk:
    """State of the order that the vehicle is to carry out.

    Parameters
    ----------
    vehicle
        Address of the vehicle, and how long to try. Every method takes the time in seconds of a
        steady clock.

    Attributes
    ----------
    order
        The active order, or None.
    reboots
        Number of restarts of the vehicle.

    """

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self.order: Order | None = None
        self.reboots = 0
        self._position = 0
        self._sent = 0
        self._next = 0.0
        self._deadline = 0.0
        self._reported = Reported()
        self._uptime = 0
        self._refused = False

    def give(self, order: Order, now: float) -> Outcome | None:
        """Begin an order; return the outcome of the one that it replaces."""
        replaced = None if self.order is None else Outcome(self.order, "replaced")
        seconds = EMERGENCY_SECONDS if order.emergency else self._vehicle.give_up_seconds
        self.order = order
        self._refused = False
        self._deadline = now + seconds * len(order.steps)
        self._begin(0, now)
        return replaced

    def list_due(self, now: float) -> Sequence[Message]:
        """Return the messages to send now."""
        if self.order is None or now < self._next or now > self._deadline:
            return ()
        message = self.order.steps[self._position].build(self._sent)
        self._sent += 1
        self._next = now + self._vehicle.repeat_seconds
        return (message,)

    def check_deadline(self, now: float) -> Outcome | None:
        """Return the outcome of an order that the vehicle has not done in time."""
        if self.order is None or now <= self._deadline:
            return None
        return self._end("unanswered")

    def hear(self, message: Message, now: float) -> Outcome | None:
        """Process a message of the vehicle.

        Returns
        -------
        The outcome of the order that the message ends; for an emergency also its first refusal.

        """
        if not self._is_from_vehicle(message):
            return None
        if message.get_type() == "SYSTEM_TIME":
            self._note_uptime(message.time_boot_ms, now)
        self._reported.hear(message)
        if self.order is None or not self._sent:
            return None
        step = self.order.steps[self._position]
        if step.is_done(self._reported):
            return self._advance(now)
        answered = message.get_type() == "COMMAND_ACK" and message.command == step.command
        if not answered or message.result in GO_ON:
            return None
        return self._refuse(message.result)

    def _refuse(self, result: int) -> Outcome | None:
        """End a refused order; an emergency goes on, and only its first refusal is reported."""
        assert self.order is not None
        names = mavlink.enums["MAV_RESULT"]
        answer = names[result].name if result in names else str(result)
        answer = answer.removeprefix("MAV_RESULT_")
        if not self.order.emergency:
            return self._end("refused", answer)
        told, self._refused = self._refused, True
        return None if told else Outcome(self.order, "refused", answer)

    def _is_from_vehicle(self, message: Message) -> bool:
        vehicle = self._vehicle
        sender = (message.get_srcSystem(), message.get_srcComponent())
        if message.get_type() != "COMMAND_ACK":
            return sender == (vehicle.system, vehicle.component)
        # Answers to a ground station arrive here too; older vehicles send no address.
        ours = ((0, 0), (vehicle.system, OUR_COMPONENT))
        answering = (
            (vehicle.system, part) for part in (vehicle.component, vehicle.camera_component)
        )
        return sender in answering and (message.target_system, message.target_component) in ours

    def _note_uptime(self, uptime: int, now: float) -> None:
        """Detect a restart of the vehicle, which has then lost its orders."""
        if uptime + REBOOT_MS < self._uptime:
            self.reboots += 1
            self._reported = Reported()
            if self.order is not None:
                self._begin(0, now)
        self._uptime = uptime

    def _advance(self, now: float) -> Outcome | None:
        assert self.order is not None
        if self._position + 1 == len(self.order.steps):
            return self._end("done")
        self._begin(self._position + 1, now)
        return None

    def _begin(self, position: int, now: float) -> None:
        """Begin a step; earlier reports of the vehicle do not prove it."""
        self._position, self._sent, self._next = position, 0, now
        self._reported = Reported()

    def _end(self, kind: OutcomeKind, answer: str = "") -> Outcome:
        assert self.order is not None
        order, self.order = self.order, None
        return Outcome(order, kind, answer)
