"""Patterns: the pulses by which lights and tilt show a reply, and what was before them.

`PatternPlayer` plays one output, `ReplyDesk` chooses the reply; `app.robot.commands.replies` says
how many pulses it has. A pattern begins only when the vehicle reports the present value, and the
pilot did not change it a moment ago. A value that is neither ours nor the one before is the
pilot's: the pattern ends, and that value stays. The value before is kept in a file while a pattern
is played, so that a robot that starts again restores it too.

Times are seconds of a steady clock, or heard seconds: only those in which the vehicle reports the
value, so that a lost link uses up none.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Final

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.commands.replies import Reply
from app.robot.mavlink.actions import GO_ON, CommandStep, Message, Step, VehicleFacts
from app.robot.mavlink.lights_and_tilt import LightsOutput, Output, TiltOutput, build_command
from app.robot.mavlink.memory import Memory
from app.robot.mavlink.orders import is_from_vehicle
from app.robot.mavlink.table import Replies, Vehicle

REPORT_SECONDS: Final = 0.1
"""Seconds between two reports that the vehicle is asked for: less than half a pulse."""

FRESH_SECONDS: Final = 2.0
"""Seconds after which a reported value is not known to be the present one."""

ASK_REPORT_SECONDS: Final = 5.0
"""Seconds between two requests for reports that do not come."""

PILOT_SECONDS: Final = 5.0
"""Seconds without replies after the pilot has changed the value."""

RESEND_SECONDS: Final = 0.2
"""Seconds after which a value that is not reported is sent again: twice the reports' period."""

LONGEST_LEVEL: Final = 1.5
"""Heard seconds after which the next value is sent though the present one was never reported."""

LONGEST_RESTORE: Final = 30.0
"""Heard seconds after which the value before is given up: the vehicle does not do what it is
asked."""

PAUSE_SECONDS: Final = 1.0
"""Seconds between two patterns, twice the time between two pulses, so that they are counted apart;
also after an order that sets the output."""

ACKNOWLEDGE_SECONDS: Final = 1.0
"""Seconds after its message within which an acknowledgement is a pattern's; a later one is an
order's."""

OUTDATED_SECONDS: Final = 1.0
"""Seconds after an order within which a reported value may be that from before it, and no pilot's.
"""

LATEST_SECONDS: Final = 6.0
"""Seconds after which a reply that could not begin is dropped: the diver has gone on."""

NOT_SHOWN: Final = "not shown to the diver"
"""Beginning of the line about a reply that could not be shown."""


class PatternPlayer:
    """State of one output; every method takes the time in seconds of a steady clock.

    Parameters
    ----------
    output
        What shows the pulses.
    memory
        Keeps the value before a pattern until it is restored.

    """

    def __init__(self, output: Output, memory: Memory) -> None:
        self.output = output
        self._memory = memory
        self._is_refused = False
        self._value = self._before = self._expected = math.nan
        # What is sent for a pulse, and what is then reported: the vehicle may have limits.
        self._peak = self._shown_peak = math.nan
        self._has_shown = False
        self._heard = self._changed = self._asked = self._rested = self._handed = -math.inf
        # Whether a pulse is on, and whether the following parts of the pattern are.
        self._is_on: bool | None = None
        self._sent = self._ticked = -math.inf
        # Heard seconds of the present part.
        self._lasted = 0.0
        # When an order for the output is given up, and the value before it may be restored.
        self._yields = -math.inf
        # Whether the next report ends a silence, in which the pilot may have set anything.
        self._was_silent = True
        self._following: deque[bool] = deque()
        self._unacknowledged = 0
        if len(kept := memory.find(output.key)) == 3:
            self._before, self._peak, self._shown_peak = kept
            self._is_on = False

    @property
    def is_active(self) -> bool:
        """Whether a pattern is played, or the value before is not restored yet."""
        return self._is_on is not None

    def find_obstacle(self, now: float) -> str:
        """Return, in few words, why no pattern can begin now; empty if one can."""
        if self._is_refused:
            return f"vehicle refuses to set {self.output.name}"
        if self.output.obstacle:
            return self.output.obstacle
        if now - self._heard > FRESH_SECONDS:
            return f"vehicle does not report {self.output.name}"
        if now - self._changed < PILOT_SECONDS:
            return f"pilot has changed {self.output.name}"
        return ""

    def is_free(self, now: float) -> bool:
        """Return whether the pattern before and the pause after it are over."""
        return not self.is_active and now - max(self._rested, self._handed) >= PAUSE_SECONDS

    def begin(self, pulses: int, now: float) -> None:
        """Begin a pattern of so many pulses; nothing may be in its way."""
        self._before, self._expected = self._value, math.nan
        self._peak = self._shown_peak = self.output.find_peak(self._value)
        self._has_shown = False
        self._following = deque([True, False] * pulses)
        self._memory.keep(self.output.key, self._before, self._peak, self._shown_peak)
        self._turn(self._following.popleft())

    def stop(self, now: float) -> None:
        """End the pattern and restore the value before it, once the vehicle is heard."""
        if self._following:
            self._following.clear()
            self._turn(False)

    def hand_over(self, value: float, now: float) -> Sequence[Message]:
        """Leave the output to an order that sets `value`; return what restores the value before."""
        self._expected, self._handed = value, now
        if not self.is_active:
            return []
        self._following.clear()
        self._turn(False)
        # The order may be lost: until it is given up, what is reported shows who has set it.
        self._yields = now + self.output.vehicle.give_up_seconds
        # Its acknowledgements are told from the order's by the time of the last message.
        self._sent = now
        return [self._set(self._before)]

    def forget(self) -> None:
        """Forget the pattern and the value reported before the vehicle restarted."""
        self._drop()
        self._value, self._heard = math.nan, -math.inf

    def hear(self, message: Message, now: float) -> bool:
        """Process a message of the vehicle; return whether it acknowledges a pattern."""
        if not is_from_vehicle(message, self.output.vehicle):
            return False
        if message.get_type() == "COMMAND_ACK" and message.command == self.output.command:
            return self._hear_acknowledgement(message.result, now)
        value = self.output.read(message)
        if value is not None:
            self._hear_value(value, now)
        return False

    def _hear_acknowledgement(self, result: int, now: float) -> bool:
        # A lost acknowledgement must not make a later one, to an order, count as a pattern's.
        if not self._unacknowledged or now - self._sent > ACKNOWLEDGE_SECONDS:
            self._unacknowledged = 0
            return False
        self._unacknowledged -= 1
        if result not in GO_ON:
            self._is_refused = True
            self._drop()
        return True

    def _hear_value(self, value: float, now: float) -> None:
        self._was_silent |= now - self._heard > FRESH_SECONDS
        last, self._value, self._heard = self._value, value, now
        if self.is_active:
            if self._equals(value, self._expected):
                self._drop()
            elif not self._is_ours(value):
                self._drop()
                self._changed = self._rested = now
        elif self._equals(value, self._expected):
            self._expected = math.nan
        # False before the first report. Those from before an order are on their way.
        elif abs(value - last) > self.output.tolerance and now - self._handed >= OUTDATED_SECONDS:
            self._changed = now
        self._was_silent = False

    def _is_ours(self, value: float) -> bool:
        """Return whether a value is that of a pulse, or that before, and so no pilot's.

        After a silence only these two are: what lies between them does not travel any more.
        """
        if self._was_silent:
            ours = (self._before, self._peak, self._shown_peak)
            return any(self._equals(value, sent) for sent in ours)
        low, high = sorted((self._before, self._peak))
        lies_between = low - self.output.tolerance <= value <= high + self.output.tolerance
        if self.output.travels:
            return lies_between
        if self._equals(value, self._before):
            return True
        # The first pulse shows how far the vehicle goes.
        if self._is_on and not self._has_shown and lies_between:
            self._shown_peak = value
            self._memory.keep(self.output.key, self._before, self._peak, self._shown_peak)
        self._has_shown |= self._equals(value, self._shown_peak)
        return self._equals(value, self._shown_peak)

    @property
    def _is_reached(self) -> bool:
        """Whether the present value was sent, and is reported since."""
        wanted = self._shown_peak if self._is_on else self._before
        return -math.inf < self._sent < self._heard and self._equals(self._value, wanted)

    def _equals(self, value: float, other: float) -> bool:
        return abs(value - other) <= self.output.tolerance

    def list_due(self, now: float) -> Iterator[Message]:
        """Yield the messages to send now: a value again until it is reported, then the next."""
        is_fresh = now - self._heard <= FRESH_SECONDS
        self._lasted += min(now - self._ticked, FRESH_SECONDS) if is_fresh else 0
        self._ticked = now
        if not is_fresh:
            self.stop(now)
            if now - self._asked > ASK_REPORT_SECONDS:
                self._asked = now
                vehicle, message = self.output.vehicle, float(self.output.reported_by)
                ask = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
                yield build_command(vehicle, ask, message, REPORT_SECONDS * 1e6)
            # Nothing is set unseen: the pilot may have another value by now.
            return
        if self.is_active:
            self._advance(now)
        # A value that is reached is not set again, so that a pilot may change it.
        if self.is_active and now - self._sent >= RESEND_SECONDS and not self._is_reached:
            if now < self._yields or self.output.obstacle:
                return
            self._sent = now
            yield self._set(self._peak if self._is_on else self._before)

    def _advance(self, now: float) -> None:
        """Go on to the next value when the present one has been shown long enough."""
        if not self._following:
            # A report on its way before the last message proves nothing.
            restored = self._is_reached and now - self._sent > REPORT_SECONDS
            if restored or self._lasted > LONGEST_RESTORE:
                self._drop()
                self._rested = now
        elif self._lasted > LONGEST_LEVEL or (
            self._is_reached and now - self._sent >= self.output.pulse_seconds / 2
        ):
            self._turn(self._following.popleft())

    def _turn(self, is_on: bool) -> None:
        self._is_on, self._lasted = is_on, 0.0
        self._sent = self._yields = -math.inf

    def _drop(self) -> None:
        self._following.clear()
        self._is_on = None
        self._memory.keep(self.output.key)

    def _set(self, value: float) -> Message:
        self._unacknowledged += 1
        return self.output.build(value)


class ReplyDesk:
    """State of the replies to the diver: the newest that waits, and the patterns.

    A newer reply replaces one that waits, but none replaces that of an emergency, which also ends
    the pattern that is played. No pattern is played while a take is open.

    Parameters
    ----------
    replies, vehicle
        The table's; None: nothing is shown.
    facts
        What the lights' output does.
    file
        File that keeps what was before a pattern; None: a restart forgets it.
    tell
        Called with a line for people, such as why a reply could not be shown.

    Attributes
    ----------
    is_take_open
        Whether the diver is showing a gesture.

    """

    def __init__(
        self,
        replies: Replies | None,
        vehicle: Vehicle,
        facts: VehicleFacts,
        file: Path | None,
        tell: Callable[[str], None],
    ) -> None:
        outputs = (LightsOutput(vehicle, facts), TiltOutput(vehicle))
        self._table, self._tell = replies, tell
        memory = Memory(None if replies is None else file, tell)
        shown = () if replies is None else replies.show
        self._players = [PatternPlayer(each, memory) for each in outputs if each.name in shown]
        # The reply, its pulses, when it was given, and whether to an emergency.
        self._waiting: tuple[Reply, int, float, bool] | None = None
        self.is_take_open = False

    @property
    def is_active(self) -> bool:
        """Whether something is shown, or not restored yet."""
        return any(player.is_active for player in self._players)

    @property
    def is_idle(self) -> bool:
        """Whether nothing is shown and nothing waits to be shown."""
        return self._waiting is None and not self.is_active

    def give(self, reply: Reply, now: float, *, emergency: bool = False) -> int:
        """Show a reply as soon as it may be shown; return its number of pulses, 0 for none."""
        pulses = 0 if self._table is None else self._table.count_pulses(reply)
        if pulses and (self._waiting is None or emergency or not self._waiting[3]):
            self._waiting = (reply, pulses, now, emergency)
            if emergency:
                self.stop(now)
        return pulses

    def stop(self, now: float) -> None:
        """End the patterns, and restore what was before."""
        for player in self._players:
            player.stop(now)

    def hand_over(self, step: Step, now: float) -> Iterator[Message]:
        """Leave the output that a step of an order sets to it; yield what restores it before."""
        for player in self._players:
            if isinstance(step, CommandStep) and step.command == player.output.command:
                yield from player.hand_over(step.parameters[1], now)

    def forget(self) -> None:
        """Forget the values reported before the vehicle restarted."""
        for player in self._players:
            player.forget()

    def hear(self, message: Message, now: float) -> bool:
        """Process a message of the vehicle; return whether it acknowledges a pattern only."""
        return any([player.hear(message, now) for player in self._players])

    def list_due(self, now: float, *, may_begin: bool) -> Iterator[Message]:
        """Yield the messages to send now; `may_begin`: whether a pattern may begin."""
        if self.is_take_open:
            self.stop(now)
        elif self._waiting is not None and may_begin:
            self._begin(*self._waiting[:3], now)
        for player in self._players:
            yield from player.list_due(now)

    def _begin(self, reply: Reply, pulses: int, given: float, now: float) -> None:
        obstacles = [player.find_obstacle(now) for player in self._players]
        able = [player for player, found in zip(self._players, obstacles, strict=True) if not found]
        if able and all(player.is_free(now) for player in able):
            for player in able:
                player.begin(pulses, now)
            self._waiting = None
        elif now - given > LATEST_SECONDS:
            self._waiting = None
            why = ", ".join(filter(None, obstacles)) or "another is shown"
            self._tell(f"{NOT_SHOWN}, {why}: {reply.value}")
