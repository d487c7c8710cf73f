"""When a recognised gesture becomes a command: the decisions of the command node, without ROS.

A misread gesture must not move a robot. So a command is given when the diver repeats its gesture, a
gesture can cancel, and only what the operator names as an emergency needs no repetition. Where the
language has phrases, their gestures are words: what is repeated and obeyed is the whole message.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

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
        Whether a gesture or a message has to be repeated before its command is given.
    confirm_seconds
        From a gesture to the end of its repetition, at most; of a message, to each next gesture of
        its repetition, and to where that is over.
    stale_seconds
        Between a gesture's stamp and now, at most, in either direction.
    least_confidence
        Below it a gesture counts as rejected, and a message as not understood.
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


@dataclass(frozen=True, kw_only=True)
class HeardPhrase:
    """What a recogniser says about a message of several gestures.

    Attributes
    ----------
    kind
        As in ``osg_interfaces/Phrase``; only ``complete`` is ever obeyed.
    mission
        What to do, as JSON; empty: nothing.
    text
        In words, for the diver.
    confidence
        In [0, 1], the least of its gestures.
    start, stamp
        Seconds: of its first gesture, and when the picture was taken after which it was known.
    label
        Of the gesture that it came of; None when that was rejected, and for a pause.
    language_id
        Of its language.

    """

    kind: str
    mission: str
    text: str
    confidence: float
    start: float
    stamp: float
    label: str | None
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
    phrase_labels
        What the language's phrases use: words, which mean nothing alone. Empty: no phrases.

    """

    language_id: str = ""
    commands: Mapping[str, str] = field(default_factory=dict)
    phrase_labels: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Decision:
    """What follows from a gesture, or from time going by.

    Attributes
    ----------
    command
        To be given now; None: none.
    label
        Of the gesture that means it; of a message, its words.
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
    """A gesture or a message that waits for its repetition.

    Attributes
    ----------
    label
        The gesture; of a message, its words.
    deadline
        Seconds: when the repetition must have ended; of a message, gone on or ended.
    mission
        What the message means; None: a gesture waits.

    """

    label: str
    deadline: float
    mission: str | None = None


class CommandDialogue:
    """Turns recognised gestures and messages into commands, or into none.

    Parameters
    ----------
    rules
        What to obey.

    Attributes
    ----------
    table
        What the gestures mean; without one nothing is ever given.
    pending
        What waits for its repetition; None: nothing.

    """

    def __init__(self, rules: Rules) -> None:
        self.rules = rules
        self.table = CommandTable()
        self.pending: Pending | None = None
        self._latest = -math.inf
        self._latest_phrase = (-math.inf, -math.inf)

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
        refused = self._refused(gesture, now, is_news=gesture.stamp > self._latest)
        if refused is not None:
            return Decision(refused)
        self._latest = gesture.stamp
        # Written so that a confidence of NaN is too little.
        sure = gesture.confidence >= self.rules.least_confidence
        if gesture.label is None or not sure:
            return Decision("not understood; show the gesture again")
        return self._decided(gesture.label, gesture.stamp)

    def hear_phrase(self, phrase: HeardPhrase, now: float) -> Decision:
        """Decide about what came of a gesture or a pause in a language with phrases.

        Parameters
        ----------
        phrase
            As the language's grammar makes it.
        now
            Seconds, in the clock of the stamps.

        """
        # One picture can tell of two messages: the one that it ends, and the one that it begins.
        order = (phrase.stamp, phrase.start)
        refused = self._refused(phrase, now, is_news=order > self._latest_phrase)
        if refused is None and not self.table.phrase_labels:
            refused = "ignored: the language of the commands has no phrases"
        if refused is not None:
            return Decision(refused)
        self._latest_phrase = order
        pending = self.pending if self.pending and self.pending.mission else None
        in_time = pending is not None and phrase.stamp <= pending.deadline
        if phrase.kind == "complete" and phrase.mission:
            return self._completed(phrase, pending if in_time else None)
        if phrase.kind == "continues" and pending and in_time:
            self.pending = replace(pending, deadline=phrase.stamp + self.rules.confirm_seconds)
        stays = phrase.kind in ("continues", "repeat")
        stays |= phrase.kind == "outside" and phrase.label is None
        if pending is None or stays:
            return Decision(phrase.text)
        self.pending = None
        return Decision(f"{phrase.text}; {pending.label!r} is forgotten")

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

    def _refused(
        self, heard: HeardGesture | HeardPhrase, now: float, *, is_news: bool
    ) -> str | None:
        """Tell why something is not listened to at all."""
        what = "message" if isinstance(heard, HeardPhrase) else "gesture"
        age = now - heard.stamp
        if not abs(age) <= self.rules.stale_seconds:
            return f"ignored: the {what} is stamped {age:.1f} s ago, stale or of another clock"
        if not is_news:
            return f"ignored: the {what} is not newer than the one before"
        if heard.language_id != self.table.language_id:
            return f"ignored: the {what} is of another language than the commands"
        return None

    def _decided(self, label: str, stamp: float) -> Decision:
        pending, self.pending = self.pending, None
        command = self.table.commands.get(label)
        if label in self.table.phrase_labels - self.rules.cancel - self.rules.emergency:
            # The message that waits is repeated by such gestures.
            self.pending = pending if pending and pending.mission else None
            return Decision(f"{label!r} counts within a phrase only", label=label)
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

    def _completed(self, phrase: HeardPhrase, pending: Pending | None) -> Decision:
        """Decide about a message that is over; `pending` may still be confirmed by it."""
        # Written so that a confidence of NaN is too little.
        if not phrase.confidence >= self.rules.least_confidence:
            return Decision("not understood; show the message again")
        self.pending = None
        if not self.rules.confirmed or (pending and pending.mission == phrase.mission):
            return Decision(phrase.text, phrase.mission, phrase.text)
        deadline = phrase.stamp + self.rules.confirm_seconds
        self.pending = Pending(phrase.text, deadline, phrase.mission)
        return Decision(f"repeat the message to confirm: {phrase.text}", label=phrase.text)
