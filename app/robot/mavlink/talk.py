"""Talk with a vehicle: sends and receives in a thread of its own, so that no picture waits for it.

What is said for a reason is decided elsewhere, see `Decider`; heartbeats and texts are said here.
"""

from __future__ import annotations

import threading
import time as clock
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Final, Protocol

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.recognition.errors import OsgError
from app.robot.mavlink.actions import Message
from app.robot.mavlink.links import Packet, VehicleLink
from app.robot.mavlink.peer import Sender, VehiclePeer
from app.robot.mavlink.table import Vehicle

TEXT_BYTES: Final = 50
"""Bytes of a STATUSTEXT; many displays cut longer messages to this length."""

TICK_SECONDS: Final = 0.05
"""Seconds to wait for a message: shorter than what a diver or a vehicle notices."""

HEARTBEAT_SECONDS: Final = 1.0
"""Seconds between two of our heartbeats, as MAVLink requires."""

CLOSE_SECONDS: Final = 3.5
"""Seconds that closing waits at most for the active order and the last texts, heard or not: a
service that is stopped must let go of its vehicle."""

HANG_SECONDS: Final = 1.0
"""Seconds more after which a link hangs, which must not keep the process from ending; a loaded
machine tells in them what was not done."""


class Decider(Protocol):
    """Decides what is sent; called in the thread of the talk, which holds its lock."""

    @property
    def is_busy(self) -> bool:
        """Whether an order is in progress."""

    @property
    def is_open(self) -> bool:
        """Whether closing has to wait, for what is in progress or is to be restored."""

    def hear(self, message: Message, now: float) -> None:
        """Process a message of the vehicle."""

    def list_due(self, now: float) -> Iterable[tuple[Message, bool]]:
        """Yield the messages to send now, and whether a rival of the vehicle gets them too."""

    def give_up(self) -> None:
        """Drop what is in progress: the time for closing is over."""


class VehicleTalk:
    """Talk with a vehicle over a link.

    Parameters
    ----------
    link
        Connection to the vehicle; closed with the talk.
    vehicle
        MAVLink ids of the vehicle.
    decider
        What is done with messages, and what is sent.
    tell
        Called with every line for people, from any thread.

    Attributes
    ----------
    peer
        Whose messages are the vehicle's.
    lock
        Held while something is decided. Reentrant, because a line for people may cause an event:
        that it cannot be printed.
    closing
        Set when nothing new may begin.
    is_silent
        Whether the vehicle was announced as silent.

    """

    def __init__(
        self, link: VehicleLink, vehicle: Vehicle, decider: Decider, tell: Callable[[str], None]
    ) -> None:
        self._link, self._decider, self._tell = link, decider, tell
        self._beaten = clock.monotonic()
        alert = partial(self.say, severity=mavlink.MAV_SEVERITY_ALERT)
        self.peer = VehiclePeer(vehicle, self._beaten, alert, link.expected)
        self.lock = threading.RLock()
        self.is_silent = self._is_broken = False
        self._texts: list[Message] = []
        self._fault: Exception | None = None
        self.closing = threading.Event()
        self._close_by = float("inf")
        self._thread = threading.Thread(target=self._work, name="mavlink", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def check(self) -> None:
        """Raise the error that ended the thread, if any."""
        if self._fault is not None:
            raise self._fault

    def close(self) -> None:
        """Wait for what is in progress, at most `CLOSE_SECONDS`, and disconnect.

        Texts that were announced before are sent to the vehicle's displays first.
        """
        self._close_by = clock.monotonic() + CLOSE_SECONDS
        self.closing.set()
        self._thread.join(CLOSE_SECONDS + HANG_SECONDS)

    def say(self, text: str, severity: int = mavlink.MAV_SEVERITY_INFO) -> None:
        """Announce a text here and on the displays of the vehicle's network."""
        self._tell(text)
        self._texts.append(mavlink.MAVLink_statustext_message(severity, fit_text(text)))

    def _work(self) -> None:
        """Exchange messages with the vehicle until the talk is closed; runs in the thread."""
        try:
            while self._is_needed():
                self._exchange()
            ignored = self.peer.dropped + self._link.dropped
            if ignored:
                self._tell(f"{ignored} messages that are not the vehicle's were ignored")
        except Exception as error:  # passed on to the thread that publishes
            self._fault = error
        finally:
            self._link.close()

    def _is_needed(self) -> bool:
        """Return whether the thread goes on: not after the time for closing is over."""
        if clock.monotonic() > self._close_by:
            with self.lock:
                self._decider.give_up()
            return False
        return not self.closing.is_set() or self._decider.is_open or bool(self._texts)

    def _exchange(self) -> None:
        """Receive what has arrived, and send what is due."""
        packets: Sequence[Packet] = ()
        fault = ""
        try:
            packets = self._link.receive(TICK_SECONDS)
        except (OSError, OsgError) as error:
            fault = str(error)
            self.closing.wait(TICK_SECONDS)
        with self.lock:
            due = self._take_turn(packets)
        # Though nothing can be heard, what is sent may arrive.
        try:
            for message, receiver in due:
                self._link.send(message, receiver)
        except (OSError, OsgError) as error:
            fault = str(error)
        if fault and not self._is_broken:
            self._tell(f"no connection to the vehicle: {fault}")
        if fault or due:
            self._is_broken = bool(fault)

    def _take_turn(self, packets: Sequence[Packet]) -> list[tuple[Message, Sender | None]]:
        """Process the received messages and return the messages to send, and to whom."""
        now = clock.monotonic()
        self.peer.expect(self._link.expected)
        for message, sender in packets:
            if self.peer.admit(message, sender, now, busy=self._decider.is_busy):
                self._decider.hear(message, now)
        if self.is_silent != self.peer.is_silent(now):
            self.is_silent = not self.is_silent
            words = "vehicle is silent" if self.is_silent else "vehicle is back"
            self.say(words, mavlink.MAV_SEVERITY_ALERT)
        # Orders first: an emergency does not wait for texts, of which each may take its time.
        due = [*self._decider.list_due(now), *((text, True) for text in self._texts)]
        self._texts.clear()
        if now - self._beaten >= HEARTBEAT_SECONDS:
            self._beaten = now
            due.append((build_heartbeat(), True))
        both, vehicle = self.peer.claimants, [self.peer.sender]
        return [(each, to) for each, is_shared in due for to in (both if is_shared else vehicle)]


def build_heartbeat() -> Message:
    """Build our heartbeat: that of an on-board computer, not of an autopilot."""
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_ONBOARD_CONTROLLER,
        mavlink.MAV_AUTOPILOT_INVALID,
        0,
        0,
        mavlink.MAV_STATE_ACTIVE,
        3,  # version of MAVLink's heartbeat
    )


def fit_text(text: str) -> bytes:
    """Return a text in UTF-8, cut after the last whole character that fits a STATUSTEXT."""
    return text.encode()[:TEXT_BYTES].decode("utf-8", "ignore").encode()
