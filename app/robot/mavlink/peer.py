"""Vehicle peer: decides whose messages are the vehicle's, without a network.

The peer is the address from which a heartbeat of the table's system and component came, of a
submarine with ArduPilot. It stays the peer while it is heard. A heartbeat of another kind ends
that, until one of a submarine comes again. All else is dropped and counted.

A second submarine with the same ids is a rival, unless the table or the link names the address:
nobody knows then which one is the vehicle. A heartbeat of our own component from the vehicle's
address is another robot that commands it, which is told.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Final, Literal

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink.actions import OUR_COMPONENT, Message, name_entry
from app.robot.mavlink.heard import SILENT_SECONDS, HeardClock
from app.robot.mavlink.orders import REBOOT_MS
from app.robot.mavlink.table import Vehicle

Sender = tuple[Any, ...]
"""Address of a socket; empty for a connection that has one sender alone."""

Place = Literal["own", "free", "taken", "foreign"]
"""Of an address: the vehicle's, or the first one; one that the silent vehicle may have moved to; a
rival's, because the vehicle is at another; one that the link or the table excludes."""

NO_ARDUSUB: Final = "no ArduSub"

NOTE_AGAIN_SECONDS: Final = 60.0
"""Seconds without a sender that is ignored after which the next one is announced again."""

RIVAL_SECONDS: Final = 10.0
"""Heard seconds after the last heartbeat of a rival in which it still counts as one."""

MOST_RIVALS: Final = 4
"""Rivals that are kept, so that a flood of addresses is no flood of commands."""


class VehiclePeer:
    """State of the other end of a link.

    Parameters
    ----------
    vehicle
        MAVLink ids of the vehicle.
    now
        Present time; every method takes it in seconds of a steady clock.
    tell
        Called with a line for people.
    expected
        The only address that may be the vehicle's; None for any.

    Attributes
    ----------
    sender
        Address of the vehicle; None before its first valid heartbeat.
    dropped
        Number of messages that were not the vehicle's.

    """

    def __init__(
        self, vehicle: Vehicle, now: float, tell: Callable[[str], None], expected: Sender | None
    ) -> None:
        self._vehicle = vehicle
        self._expected = expected
        self.sender: Sender | None = None
        self.dropped = 0
        self._tell = tell
        self._two = f"two vehicles with system {vehicle.system}"
        # A rival's last heartbeat, in heard seconds; None: it has the vehicle's own address.
        self._rivals: dict[Sender | None, float] = {}
        self._heard_clock = HeardClock(now)
        self._refused = self._contradicted = -math.inf
        self._faulty: Sender | None = None
        self._clock: tuple[int, float] | None = None
        self._set_back = self._addresses = False
        self._noted: dict[str, float] = {}

    def expect(self, sender: Sender | None) -> None:
        """Set the only address that may be the vehicle's; a new one has to prove itself."""
        if sender != self._expected:
            self._expected, self.sender = sender, None
            self._rivals.clear()

    def find_fault(self, now: float) -> str:
        """Return, in few words, why nothing may be sent to the vehicle; empty for no fault."""
        is_faulty = self.sender in (None, self._faulty)
        return NO_ARDUSUB if is_faulty and now - self._refused <= SILENT_SECONDS else ""

    @property
    def claimants(self) -> list[Sender | None]:
        """Addresses of the vehicle and its rivals; None while nothing is known."""
        return [self.sender, *(rival for rival in self._rivals if rival is not None)]

    @property
    def contest(self) -> str:
        """Why nothing that is heard proves anything: there is a rival; empty for none."""
        return self._two if self._rivals else ""

    def is_proven(self, now: float) -> bool:
        """Return whether commands may be sent."""
        return self.sender is not None and not self.find_fault(now)

    def is_silent(self, now: float) -> bool:
        """Return whether its last heartbeat is too long ago."""
        return now - self._heard_clock.last > SILENT_SECONDS

    def admit(self, message: Message, sender: Sender, now: float, *, busy: bool) -> bool:
        """Return whether a message comes from the vehicle's address, and may be believed.

        Parameters
        ----------
        message, sender
            The message and its address.
        now
            Seconds of a steady clock.
        busy
            Whether an order is in progress: the peer then changes to an address of the same host
            alone, such as a router that was started again.

        """
        named = (message.get_srcSystem(), message.get_srcComponent())
        is_its = named == (self._vehicle.system, self._vehicle.component)
        if is_its and message.get_type() == "HEARTBEAT":
            kind = describe_other_kind(message)
            match ("other" if kind else "sub", self._find_place(sender, now, busy=busy)):
                case ("sub", "own" | "free"):
                    self._believe(sender, now)
                case ("sub", "taken"):
                    self._note_rival(sender)
                case ("other", "own"):
                    self._refuse(sender, kind, now)
                case _:
                    notice = f"{self._two}{name_address(sender)} is ignored"
                    self._note("ignored", notice, now)
        if sender == self.sender:
            if named == (self._vehicle.system, OUR_COMPONENT):
                self._note("robot", "another robot commands this vehicle too", now)
            elif is_its and message.get_type() == "SYSTEM_TIME":
                self._watch_clock(message.time_boot_ms, now)
        admitted = sender == self.sender and self.is_proven(now)
        admitted = admitted and not (is_its and self._is_for_another(message))
        self.dropped += not admitted
        return admitted

    def _find_place(self, sender: Sender, now: float, *, busy: bool) -> Place:
        """Return whether an address is, or may become, that of the vehicle."""
        named = self._vehicle.address
        if self._expected is not None:
            is_named = sender == self._expected
        else:
            is_named = named is None or sender[:1] == (str(named),)
        if not is_named:
            return "foreign"
        if self.sender is None or sender == self.sender:
            return "own"
        may_move = not busy or sender[:1] == self.sender[:1]
        return "free" if may_move and self.is_silent(now) else "taken"

    def _believe(self, sender: Sender, now: float) -> None:
        """Take an address for the vehicle's, unless it has just sent as another kind."""
        if sender == self._faulty and self.find_fault(now):
            return
        if sender != self.sender:
            if self._rivals.pop(sender, None) is not None:
                self._rivals[self.sender] = self._heard_clock.seconds
            self.sender, self._clock, self._addresses = sender, None, False
        self._heard_clock.hear(now)
        least = self._heard_clock.seconds - RIVAL_SECONDS
        self._rivals = {each: last for each, last in self._rivals.items() if last >= least}

    def _refuse(self, sender: Sender, kind: str, now: float) -> None:
        """Leave a vehicle that is no submarine."""
        if not self.find_fault(now):
            self._tell(f"vehicle is no ArduSub but {kind}; nothing is sent")
        self._faulty, self._refused, self.sender = sender, now, None

    def _is_for_another(self, message: Message) -> bool:
        """Return whether a vehicle that addresses its acknowledgements gives this one no address.

        Older vehicles address none.
        """
        if message.get_type() != "COMMAND_ACK":
            return False
        self._addresses |= message.target_system != 0
        return self._addresses and message.target_system == 0

    def _note_rival(self, sender: Sender | None) -> None:
        """Keep a second submarine with the same ids, and announce it once while it is heard."""
        if sender not in self._rivals:
            if len(self._rivals) == MOST_RIVALS:
                return
            self._tell(f"{self._two}, orders wait{name_address(sender)}")
        self._rivals[sender] = self._heard_clock.seconds

    def _note(self, kind: str, notice: str, now: float) -> None:
        """Announce what is heard again and again, once for each kind while it is heard."""
        if now - self._noted.get(kind, -math.inf) > NOTE_AGAIN_SECONDS:
            self._tell(notice)
        self._noted[kind] = now

    def _watch_clock(self, uptime: int, now: float) -> None:
        """Detect two vehicles behind one address: their clocks jump back and forth.

        A vehicle that starts again goes back and never returns; one late packet does both once.
        """
        before, self._clock = self._clock, (uptime, now)
        if before is None:
            return
        passed = (now - before[1]) * 1000
        if uptime + REBOOT_MS < before[0]:
            self._set_back = True
        elif self._set_back and uptime - before[0] > passed + REBOOT_MS:
            self._set_back = False
            if now - self._contradicted <= SILENT_SECONDS:
                self._note_rival(None)
            self._contradicted = now


def name_address(sender: Sender | None) -> str:
    """Return an address for a line, such as ``: 192.168.2.2:14550``; empty for None."""
    return "" if sender is None else f": {':'.join(str(part) for part in sender[:2])}"


def describe_other_kind(heartbeat: Message) -> str:
    """Describe the kind of a vehicle that is no ArduSub; empty for an ArduSub.

    The numbers of modes mean something else in every other kind, so none may be sent there.
    """
    if (heartbeat.type, heartbeat.autopilot) == (
        mavlink.MAV_TYPE_SUBMARINE,
        mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
    ):
        return ""
    numbers = {"MAV_AUTOPILOT": heartbeat.autopilot, "MAV_TYPE": heartbeat.type}
    return ", ".join(name_entry(enum, each) or f"{enum} {each}" for enum, each in numbers.items())
