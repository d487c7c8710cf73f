"""Vehicle orders: sends the steps of one mission until each is proven done, without a network.

`OrderDesk` holds the active order. There is no queue: a newer mission replaces it, so that no
action is done long after its request. `ModeWatch` notices a pilot who sets another mode, and wins.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from app.robot.mavlink.actions import (
    GO_ON,
    OUR_COMPONENT,
    DepthStep,
    Message,
    Reported,
    Step,
    VehicleFacts,
    describe_step,
    name_entry,
)
from app.robot.mavlink.heard import LONGEST_GAP, SILENT_SECONDS, HeardClock
from app.robot.mavlink.table import Vehicle

EMERGENCY_SECONDS: Final = 60.0
"""Heard seconds for which an emergency is repeated; after that the vehicle has another pilot. A
lost link uses up none: what saves a diver is sent when the vehicle is back."""

REBOOT_MS: Final = 1000
"""Milliseconds by which packets out of order may set back the vehicle's time since boot."""

SHOW_SECONDS: Final = LONGEST_GAP
"""Heard seconds for an accepted mode to show. Until then it is not requested again."""

MOST_OVERRIDES: Final = 2
"""Accepted requests of a mode that did not show it, after which the order ends: a pilot may set the
old one. The first acknowledgement may be a late one, of an earlier request."""

LATE_SECONDS: Final = 10.0
"""Heard seconds after a request, or after it was given up, in which the vehicle may still take that
mode, for an order that was cancelled or replaced meanwhile: no pilot has set it then."""

OTHER_PILOT: Final = "the pilot changed the mode"

DISARMED: Final = "vehicle is disarmed"

OutcomeKind = Literal[
    "done", "refused", "unproven", "replaced", "cancelled", "stopped", "waits", "late"
]


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
    others
        What of an emergency is tried instead, in order, when it is refused or has no effect; then
        the first one again.

    """

    words: str
    steps: tuple[Step, ...]
    emergency: bool = False
    others: tuple[Order, ...] = ()

    @property
    def moves(self) -> bool:
        """Whether it moves the vehicle, which only an armed one can do."""
        return any(step.moves for step in self.steps)


@dataclass(frozen=True)
class Outcome:
    """How an order ended.

    Attributes
    ----------
    order
        The order.
    kind
        ``done``: proven by the vehicle. ``refused``: by the vehicle. ``unproven``: not proven in
        time. ``replaced``: by a newer order. ``cancelled``: by the diver. ``stopped``:
        for the `reason`. ``waits``: it goes on, in spite of the `reason`.
        ``late``: the vehicle shows what was given up, after all.
    reason
        Why, in few words, such as ``refused (DENIED)``.
    sent
        What was sent of an order that is not proven, and how often: the vehicle may still do it.

    """

    order: Order
    kind: OutcomeKind
    reason: str = ""
    sent: str = ""


class OrderDesk:
    """State of the order that the vehicle is to carry out.

    Parameters
    ----------
    vehicle
        Address of the vehicle, and how long to try: an order counts all seconds, because nothing
        may be done long after its request, an emergency heard seconds. Every method takes the time
        in seconds of a steady clock.
    facts
        What the vehicle has said of itself.

    Attributes
    ----------
    order
        The active order, or None.
    reboots
        Number of restarts of the vehicle.

    """

    def __init__(self, vehicle: Vehicle, facts: VehicleFacts) -> None:
        self._vehicle, self._facts = vehicle, facts
        self.order: Order | None = None
        self.reboots = 0
        self._position = 0
        self._sent = 0
        self._sendings: Counter[Step] = Counter()
        self._given = self._next = self._deadline = 0.0
        self._clock = HeardClock()
        self._reported = Reported()
        self._uptime = 0
        self._mode: int | None = None
        self._requested: dict[int, float] = {}
        self._armed: bool | None = None
        self._told: set[str] = set()
        self._watch = ModeWatch(None)
        self._late: Order | None = None
        self._late_by = 0.0
        self._began = 0.0
        self._proves = True

    def give(self, order: Order, now: float) -> Outcome | None:
        """Begin an order.

        Returns
        -------
        The outcome of the order that it replaces, or its own if it is not begun: an ordinary order
        never replaces an emergency, and does not move a disarmed vehicle.

        """
        if not order.emergency:
            if self.order is not None and self.order.emergency:
                return Outcome(order, "stopped", "EMERGENCY goes on")
            if order.moves and self._armed is False:
                return Outcome(order, "stopped", DISARMED)
        replaced = None if self.order is None else self._give_up("replaced")
        self.order, self._late, self._given = order, None, now
        self._told.clear()
        self._sendings.clear()
        self._deadline = now + self._vehicle.give_up_seconds * len(order.steps)
        if order.emergency:
            self._deadline = self._clock.seconds + EMERGENCY_SECONDS
        self._begin(0, now)
        return replaced

    def cancel(self) -> Outcome | None:
        """Drop the active order unless it is an emergency; return what became of it."""
        if self.order is None:
            return None
        if self.order.emergency:
            return Outcome(self.order, "waits", "EMERGENCY is not cancelled")
        return self._give_up("cancelled")

    def stop(self, reason: str) -> Outcome | None:
        """Drop the active order, also an emergency, for a reason; return its outcome."""
        return None if self.order is None else self._give_up("stopped", reason)

    def _give_up(self, kind: OutcomeKind, reason: str = "") -> Outcome:
        """End an order before it is proven; if it was sent, watch whether it is done after all."""
        order, sendings = self.order, self._sendings.items()
        numbers = ((describe_step(step), number) for step, number in sendings)
        sent = ", ".join(
            f"{step} was sent {'once' if number == 1 else f'{number} times'}"
            for step, number in numbers
        )
        outcome = replace(self._end(kind, reason), sent=sent)
        self._late, self._late_by = (order if sent else None), self._clock.seconds + LATE_SECONDS
        return self._find_late() or outcome

    @property
    def is_watched(self) -> bool:
        """Whether an order was given up that the vehicle may still do, in heard seconds."""
        return self._late is not None and self._clock.seconds <= self._late_by

    def _find_late(self) -> Outcome | None:
        """Return that an order which was given up is done, once mode and depth show it."""
        if self._late is None or self._armed is False:
            return None
        steps, shown = self._late.steps, self._reported
        modes = [step.mode for step in steps if step.mode is not None]
        left = [step for step in steps[self._position :] if step.mode is None]
        if modes[-1:] not in ([], [shown.mode]) or not all(step.is_done(shown) for step in left):
            return None
        order, self._late = self._late, None
        return Outcome(order, "late")

    def list_due(self, now: float) -> Sequence[Message]:
        """Return the messages to send now."""
        if self.order is None or now < self._next or self._watch.keeps_back:
            return ()
        if self._is_over(self.order, now):
            return ()
        # Requests may wait in the link and all be obeyed late: none is repeated before the vehicle
        # is heard again. An emergency is, for `SILENT_SECONDS`: perhaps only the way back fails.
        heard = self._clock.last
        is_urgent = self.order.emergency and now - max(heard, self._given) <= SILENT_SECONDS
        step = self.order.steps[self._position]
        if self._sent > 0:
            if step.is_done(self._reported) or (heard < self._next and not is_urgent):
                return ()
        else:
            self._reported = Reported()
        if step.mode is not None:
            self._requested[step.mode] = self._clock.seconds
        due = step.build(self._facts.version if isinstance(step, DepthStep) else self._sent)
        self._sent += 1
        self._sendings[step] += 1
        self._next = now + self._vehicle.repeat_seconds
        return (due,)

    def _is_over(self, order: Order, now: float) -> bool:
        """Return whether the active order has had its time."""
        return (self._clock.seconds if order.emergency else now) > self._deadline

    def check_deadline(self, now: float) -> Outcome | None:
        """Return the outcome of an order that the vehicle has not done in time."""
        if self.order is None or not self._is_over(self.order, now):
            return None
        if self.order.moves and self._armed is False:
            return self._end("stopped", DISARMED)
        return self._give_up("unproven")

    def hear(self, message: Message, now: float, *, proves: bool = True) -> Outcome | None:
        """Process a message of the vehicle; `proves`: it comes from the vehicle for certain.

        Returns
        -------
        The outcome of the order that the message ends; for an emergency also its first refusal, and
        that the vehicle is disarmed.

        """
        if not is_from_vehicle(message, self._vehicle):
            return None
        self._clock.hear(now)
        if proves != self._proves:
            self._proves = proves
            self._begin(0, now)
        if not proves:
            return None
        self._note_state(message, now)
        if self.order is None:
            return self._find_late() if self.is_watched else None
        if self.order.moves and self._armed is False:
            if not self.order.emergency:
                return self._end("stopped", DISARMED)
            if DISARMED not in self._told:
                self._told.add(DISARMED)
                return Outcome(self.order, "waits", DISARMED)
        if reason := self._find_failure(self.order):
            return self._fail(self.order, reason, now)
        if self._watch.contradiction:
            return self._end("stopped", self._watch.contradiction)
        return self._hear_proof(self.order, message, now) if self._sent else None

    def _find_failure(self, order: Order) -> str:
        """Return why the next action of an emergency is due; empty if none is."""
        reason = self._watch.contradiction
        if reason == OTHER_PILOT or all(each.words in self._told for each in order.others):
            return ""
        is_shown = self._reported.mode == order.steps[self._position].mode
        is_over = self._clock.seconds - self._began > self._vehicle.give_up_seconds
        return reason or ("no effect" if is_over and not is_shown else "")

    def _hear_proof(self, order: Order, message: Message, now: float) -> Outcome | None:
        """Process what may prove or refuse the present step; `_reported` has heard it already."""
        step = order.steps[self._position]
        if step.is_done(self._reported):
            return self._advance(order, now)
        if message.get_type() != "COMMAND_ACK" or (
            (message.get_srcComponent(), message.command) != (step.component, step.command)
        ):
            return None
        # An accepted mode is not requested again until it has had `SHOW_SECONDS`, heard ones.
        self._watch.hear_acknowledgement(message.result, self._clock.seconds)
        if message.result in GO_ON:
            return None
        result = name_entry("MAV_RESULT", message.result) or str(message.result)
        return self._fail(order, f"refused ({result})", now)

    def _fail(self, failed: Order, reason: str, now: float) -> Outcome | None:
        """End an order that is refused; of an emergency try the next action, told once for each."""
        if not failed.emergency:
            return self._end("refused", reason)
        is_new = failed.words not in self._told
        self._told.add(failed.words)
        following, *later = (*failed.others, replace(failed, others=()))
        self.order = replace(following, others=tuple(later))
        if later:
            self._begin(0, now if is_new else now + self._vehicle.repeat_seconds)
        if not is_new:
            return None
        if following.words in self._told:
            return Outcome(failed, "refused", reason)
        return Outcome(failed, "waits", f"{reason}, now {following.words}")

    def _note_state(self, message: Message, now: float) -> None:
        """Note what a message says of the vehicle's state."""
        self._reported.hear(message)
        match message.get_type():
            case "SYSTEM_TIME":
                # A vehicle that has started again has lost its orders.
                if message.time_boot_ms + REBOOT_MS < self._uptime:
                    self.reboots += 1
                    self._reported, self._mode = Reported(), None
                    self._begin(0, now)
                self._uptime = message.time_boot_ms
                self._watch.hear_clock()
            case "HEARTBEAT":
                self._mode = int(message.custom_mode)
                self._armed = bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
                self._watch.hear_mode(self._mode, self._clock.seconds, sent=self._sent > 0)

    def _advance(self, order: Order, now: float) -> Outcome | None:
        if self._position + 1 < len(order.steps):
            self._begin(self._position + 1, now)
            return None
        return None if order.moves and self._armed is False else self._end("done")

    def _begin(self, position: int, now: float) -> None:
        """Begin a step of the active order, if any; earlier reports do not prove it."""
        if self.order is None:
            return
        self._position, self._sent, self._next = position, 0, now
        self._began = self._clock.seconds
        self._reported = Reported()
        modes = [step.mode for step in self.order.steps[: position + 1] if step.mode is not None]
        is_shown = bool(modes) and self.order.steps[position].mode is None
        least = self._clock.seconds - LATE_SECONDS
        late = [mode for mode, sent in self._requested.items() if sent >= least]
        self._watch = ModeWatch(
            modes[-1] if modes else None, (self._mode, *late), is_shown=is_shown
        )

    def _end(self, kind: OutcomeKind, reason: str = "") -> Outcome:
        assert self.order is not None
        order, self.order = self.order, None
        self._watch = ModeWatch(None)
        return Outcome(order, kind, reason)


class ModeWatch:
    """Watch on the vehicle's mode during a step: a pilot who sets another mode wins.

    A heartbeat may be older than the request by its period, so the first one after it proves
    nothing. A mode that contradicts the order counts once the vehicle's clock shows that it did not
    start again, or `DOUBT_SECONDS` later. All its times are heard seconds.

    Parameters
    ----------
    wanted
        Mode that the order sets or has set; None for any.
    before
        Modes that are no pilot's: that before the order, and those of orders before, which the
        vehicle may take late. None: unknown.
    is_shown
        Whether an earlier step has set the mode.

    Attributes
    ----------
    contradiction
        What is known of a mode that contradicts the order, in few words; empty for none.

    """

    DOUBT_SECONDS: Final = 0.5
    """Heard seconds after which a contradicting mode counts though no clock was heard."""

    def __init__(
        self, wanted: int | None, before: Iterable[int | None] = (), *, is_shown: bool = False
    ) -> None:
        self._wanted = wanted
        self._old = {*before}
        self._is_shown = is_shown
        self._heard_any = False
        self._accepted: float | None = None
        self._overrides = 0
        self._doubted: float | None = None
        self.contradiction = ""

    def hear_acknowledgement(self, result: int, now: float) -> None:
        """Note that the vehicle has accepted the mode, or refused it after all."""
        if result not in GO_ON:
            self._accepted = None
        elif result == mavlink.MAV_RESULT_ACCEPTED and self._accepted is None:
            self._accepted = now

    @property
    def keeps_back(self) -> bool:
        """Whether the request must not be repeated: it was accepted, or the mode is in doubt."""
        return self._accepted is not None or self._doubted is not None

    def hear_clock(self) -> None:
        """Note that the vehicle's clock goes on: a contradicting mode is then a pilot's."""
        if self._doubted is not None:
            self.contradiction = OTHER_PILOT

    def hear_mode(self, mode: int, now: float, *, sent: bool) -> None:
        """Process the mode of a heartbeat; `sent`: the mode was requested before."""
        if self._wanted is None:
            return
        if not sent and not self._is_shown:
            self._old.add(mode)
        elif mode == self._wanted:
            self._is_shown, self._doubted = True, None
        elif self._is_shown or (self._heard_any and mode not in self._old):
            if self._doubted is not None and now - self._doubted >= self.DOUBT_SECONDS:
                self.contradiction = OTHER_PILOT
            self._doubted = now if self._doubted is None else self._doubted
        else:
            self._old.add(mode)
            self._note_override(mode, now)
        self._heard_any |= sent

    def _note_override(self, mode: int, now: float) -> None:
        """Count an accepted mode that does not show: a pilot sets the old one, or nothing does."""
        if self._accepted is None or now - self._accepted <= SHOW_SECONDS:
            return
        self._accepted = None
        self._overrides += 1
        if self._overrides >= MOST_OVERRIDES:
            self.contradiction = f"stays in {name_entry('SUB_MODE', mode) or f'mode {mode}'}"


def is_from_vehicle(message: Message, vehicle: Vehicle) -> bool:
    """Return whether a message is the vehicle's own report, or acknowledges us."""
    sender = (message.get_srcSystem(), message.get_srcComponent())
    if message.get_type() != "COMMAND_ACK":
        return sender == (vehicle.system, vehicle.component)
    # What acknowledges a ground station arrives here too; older vehicles send no address.
    ours = ((0, 0), (vehicle.system, OUR_COMPONENT))
    senders = ((vehicle.system, part) for part in (vehicle.component, vehicle.camera_component))
    return sender in senders and (message.target_system, message.target_component) in ours
