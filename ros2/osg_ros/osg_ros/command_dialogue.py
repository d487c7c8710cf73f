"""When a recognised gesture becomes a command: the decisions of the command node, without ROS.

A misread gesture must not move a robot. So a command is given when the diver repeats its gesture, a
gesture can cancel, and only what the operator names as an emergency needs no repetition.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

CONFIRM_SECONDS = 20.0
"""A diver reads the answer off the robot's display and shows a gesture again, salutes included; the
sample clips take 4 to 6 s a gesture, so this leaves two attempts."""

STALE_SECONDS = 3.0
"""From the picture that ended a gesture until it is heard. Pose estimation on a slow robot takes
well below a second; what comes later was held up, replayed, or stamped by a wrong clock."""


@dataclass(frozen=True)
class Rules:
    """What a `CommandDialogue` obeys.

    Attributes
    ----------
    confirmed
        Whether a gesture has to be repeated before its command is given.
    confirm_seconds
        From a gesture to the end of its repetition, at most.
    stale_seconds
        Between a gesture's stamp and now, at most, in either direction.
    least_confidence
        Below it a gesture counts as rejected.
    cancel
        Labels that take back what waits for its repetition. Their own commands are not given.
    emergency
        Labels whose commands are given at once.

    Raises
    ------
    ValueError
        When a number is out of its range, or a label both cancels and is an emergency.

    """

    confirmed: bool = True
    confirm_seconds: float = CONFIRM_SECONDS
    stale_seconds: float = STALE_SECONDS
    least_confidence: float = 0.0
    cancel: frozenset[str] = frozenset()
    emergency: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        """Check what would make a robot obey in the wrong moment."""
        for name in ("confirm_seconds", "stale_seconds"):
            seconds = getattr(self, name)
            if not (math.isfinite(seconds) and seconds > 0):
                raise ValueError(f"{name} is {seconds}; give seconds above 0")
        if not 0 <= self.least_confidence <= 1:
            raise ValueError(f"least_confidence is {self.least_confidence}; give 0 to 1")
        if both := sorted(self.cancel & self.emergency):
            raise ValueError(
                f"{both} cancel and are emergencies as well; take them out of one of the two lists"
            )


@dataclass(frozen=True)
class HeardGesture:
    """What a recogniser says about one take.

    Attributes
    ----------
    label
        The gesture; None when rejected.
    confidence
        In [0, 1].
    stamp
        Seconds: when the picture that ended the take was taken.
    language_id
        Of the language it was recognised by.

    """

    label: str | None
    confidence: float
    stamp: float
    language_id: str


@dataclass(frozen=True)
class CommandTable:
    """What the gestures of a language mean.

    Attributes
    ----------
    language_id
        Of that language.
    commands
        Per label its command; labels without one are left out.

    """

    language_id: str = ""
    commands: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Decision:
    """What follows from a gesture, or from time going by.

    Attributes
    ----------
    command
        To be given now; None: none.
    label
        Of the gesture that means it.
    emergency
        Whether it was given without a repetition because it is an emergency.
    reason
        One line for the diver's display and the log.

    """

    reason: str
    command: str | None = None
    label: str | None = None
    emergency: bool = False


@dataclass(frozen=True)
class Pending:
    """A gesture that waits for its repetition.

    Attributes
    ----------
    label
        The gesture.
    deadline
        Seconds: when the repetition must have ended.

    """

    label: str
    deadline: float


class CommandDialogue:
    """Turns recognised gestures into commands, or into none.

    Parameters
    ----------
    rules
        What to obey.

    Attributes
    ----------
    table
        What the gestures mean; without one nothing is ever given.
    pending
        The gesture that waits for its repetition; None: none.

    """

    def __init__(self, rules: Rules) -> None:
        self.rules = rules
        self.table = CommandTable()
        self.pending: Pending | None = None
        self._latest = -math.inf

    def speak(self, table: CommandTable) -> Decision | None:
        """Take another language; what was begun in the old one is forgotten.

        The same language again changes nothing.

        Returns
        -------
        What that means for the diver; None where nothing was begun.

        """
        before, self.table = self.table, table
        if self.pending is None or table == before:
            return None
        label, self.pending = self.pending.label, None
        return Decision(f"{label!r} is forgotten: another language was loaded; show it again")

    def hear(self, gesture: HeardGesture, now: float) -> Decision:
        """Decide about a gesture.

        Parameters
        ----------
        gesture
            As recognised.
        now
            Seconds, in the clock of the stamps.

        """
        refused = self._refused(gesture, now)
        if refused is not None:
            return Decision(refused)
        self._latest = gesture.stamp
        # Written so that a confidence of NaN is too little.
        sure = gesture.confidence >= self.rules.least_confidence
        if gesture.label is None or not sure:
            return Decision("not understood; show the gesture again")
        return self._decided(gesture.label, gesture.stamp)

    def wait(self, now: float) -> Decision | None:
        """Let time go by.

        Parameters
        ----------
        now
            Seconds, in the clock of the stamps.

        Returns
        -------
        What that changes. A repetition that ended in time but is not heard yet is waited for as
        long as it would not be stale.

        """
        pending = self.pending
        if pending is None or now <= pending.deadline + self.rules.stale_seconds:
            return None
        self.pending = None
        return Decision(f"{pending.label!r} was not repeated in time; show it twice")

    def _refused(self, gesture: HeardGesture, now: float) -> str | None:
        """Tell why a gesture is not listened to at all."""
        age = now - gesture.stamp
        if not abs(age) <= self.rules.stale_seconds:
            return f"ignored: the gesture is stamped {age:.1f} s ago, stale or of another clock"
        if gesture.stamp <= self._latest:
            return "ignored: the gesture is not newer than the one before"
        if gesture.language_id != self.table.language_id:
            return "ignored: the gesture is of another language than the commands"
        return None

    def _decided(self, label: str, stamp: float) -> Decision:
        pending, self.pending = self.pending, None
        command = self.table.commands.get(label)
        if label in self.rules.cancel:
            what = f"{pending.label!r} is cancelled" if pending else "nothing to cancel"
            return Decision(what, label=label)
        if command is None:
            return Decision(f"{label!r} has no command", label=label)
        if label in self.rules.emergency:
            return Decision(f"emergency {label!r}: {command}", command, label, emergency=True)
        in_time = pending is not None and stamp <= pending.deadline
        if not self.rules.confirmed or (in_time and pending and pending.label == label):
            return Decision(f"{label!r}: {command}", command, label)
        self.pending = Pending(label, stamp + self.rules.confirm_seconds)
        return Decision(f"repeat {label!r} to confirm: {command}", label=label)
