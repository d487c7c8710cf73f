"""Command dialogue: decides when a recognised gesture becomes a command, without ROS.

A misrecognised gesture must not move a robot. So a command is given when the diver repeats its
gesture, a gesture can cancel, and only the operator's emergency labels need no repetition. A cancel
is never ignored, however old it is, because stopping is the safe direction. An emergency may be
older than other gestures, but must be sure, near, stamped, and of the language of the commands. All
else is taken in the order of arrival, while it is fresh. A take that lies between two gestures
commands nothing: the diver is asked back and shows the gesture again, which decides and confirms.
In a language with phrases the whole message is repeated and executed, not its single gestures.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar

# Relative, because ROS 2's package has links to these files and no `app`.
from .replies import Reply, find_phrase_reply
from .rules import EMERGENCY_LIMIT, Rules, to_number

MOST_BODIES = 32
"""Number of bodies whose last event is kept: more than the divers near one robot."""


@dataclass(frozen=True)
class Showing:
    """What a diver has shown. What is no finite number becomes NaN, which commands nothing.

    Attributes
    ----------
    label
        The gesture, for a message the one that caused its event; None for a pair, a rejected
        gesture and a pause.
    confidence
        In [0, 1]; of a message the lowest of its gestures.
    stamp
        Time of the picture that ended the take, or after which the message was known, in seconds.
    language_id
        Id of the language that recognised it.
    start
        Time at which the take or the first gesture began, in seconds; None, of a gesture alone: at
        `stamp`.
    body_id
        Whose gesture or message it is.
    pair
        The two gestures between which the take lies, and of which the diver is asked; None: it lies
        between no two.
    novelty
        That of a gesture, see `Recognition`; 0 where it is not known. NaN is not sure.
    noun
        What it is called.

    """

    label: str | None
    confidence: float
    stamp: float
    language_id: str
    start: float | None = None
    body_id: str = ""
    pair: tuple[str, str] | None = None
    novelty: float = 0.0
    noun: ClassVar[str] = "gesture"

    def __post_init__(self) -> None:
        """Make floats of numbers from outside, and NaN of what is none; see `to_number`."""
        for name in ("confidence", "stamp", "start", "novelty"):
            # Only a gesture may lack its beginning: a message without one is not sure.
            if name != "start" or self.start is not None or isinstance(self, RecognizedPhrase):
                object.__setattr__(self, name, to_number(getattr(self, name)))

    @property
    def began(self) -> float:
        """Time at which it began, in seconds."""
        return self.stamp if self.start is None else min(self.start, self.stamp)


class RecognizedGesture(Showing):
    """Recognition of one take."""


@dataclass(frozen=True, kw_only=True)
class RecognizedPhrase(Showing):
    """Recognition of a message of several gestures.

    Attributes
    ----------
    kind
        As in ``osg_interfaces/Phrase``; only ``complete`` leads to a command.
    mission
        The mission as JSON; empty for none.
    text
        Description for the diver.

    """

    kind: str
    mission: str
    text: str
    noun: ClassVar[str] = "message"


@dataclass(frozen=True)
class CommandTable:
    """Commands of a language's gestures.

    Attributes
    ----------
    language_id
        Id of the language.
    commands
        Command of each label; labels without a command are left out.
    phrase_labels
        Labels that the language's phrases use; they have no meaning alone. Empty: no phrases.

    """

    language_id: str = ""
    commands: Mapping[str, str] = field(default_factory=dict)
    phrase_labels: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Decision:
    """Result of a gesture or of elapsed time.

    Attributes
    ----------
    command
        Command to give now; None for no command.
    label
        Label of the gesture; for a message, its text.
    emergency
        Whether the command needed no repetition because its label is an emergency.
    reason
        One line for the diver's display and the log.
    cancels
        Whether the diver takes back what was asked before, also a command in progress.
    reply
        What the diver should see; None: nothing, or not before the command is carried out.

    """

    reason: str
    command: str | None = None
    label: str | None = None
    emergency: bool = False
    cancels: bool = False
    reply: Reply | None = None


@dataclass(frozen=True)
class Pending:
    """A gesture, a pair or a message that waits for its repetition.

    Attributes
    ----------
    label
        Label of the gesture, of a pair both; for a message, its text.
    deadline
        Time by which the repetition must have ended, in seconds; for a message, ended or continued.
    mission
        Mission of the message; None for a gesture.
    body_id
        Who must repeat it.
    labels
        Labels of the gestures that confirm: one, or those of a pair; none for a message.
    asked
        Whether the diver was asked back, so that a second pair is refused.

    """

    label: str
    deadline: float
    mission: str | None = None
    body_id: str = ""
    labels: tuple[str, ...] = ()
    asked: bool = False


@dataclass(frozen=True)
class Shown:
    """Last event of one body, kept to distinguish it from its repetition.

    Attributes
    ----------
    stamp, started
        Stamp and beginning of the last event, in seconds: later events are newer.
    middle
        Middle of the last gesture or message that was understood. An event that began before it is
        the same gesture or message, recognised by another camera or recogniser.

    """

    stamp: float = -math.inf
    started: float = -math.inf
    middle: float = -math.inf


class CommandDialogue:
    """Dialogue that decides which recognised gestures and messages become commands.

    Parameters
    ----------
    rules
        Rules of the decisions.

    Attributes
    ----------
    table
        Commands of the active language; an empty table gives no commands.
    pending
        Gesture, pair or message that waits for its repetition, or None.

    """

    def __init__(self, rules: Rules) -> None:
        self.rules = rules
        self.table = CommandTable()
        self.pending: Pending | None = None
        self._now = -math.inf
        self._gestures: dict[str, Shown] = {}
        self._messages: dict[str, Shown] = {}

    def set_table(self, table: CommandTable) -> Decision | None:
        """Set the commands of another language and clear a pending gesture or message.

        Setting the same table again changes nothing.

        Returns
        -------
        A decision that informs the diver; None where nothing was pending.

        """
        before, self.table = self.table, table
        if self.pending is None or table == before:
            return None
        label, self.pending = self.pending.label, None
        words = f"{label!r} is forgotten: another language was loaded; show it again"
        return Decision(words, reply=Reply.refused)

    def decide(self, gesture: RecognizedGesture, now: float) -> Decision:
        """Decide about a gesture.

        Parameters
        ----------
        gesture
            The recognised gesture.
        now
            Current time in seconds, in the clock of the stamps.

        """
        self._follow_clock(now)
        # Of a pair each gesture has a low confidence, and it commands nothing.
        least = 0.0 if gesture.pair else self.rules.least_confidence
        if is_emergency := gesture.label in self.rules.emergency:
            least = max(least, self.rules.emergency_confidence)
        # False for NaN too, of both: what is no share of 1 is no confidence.
        sure = least <= gesture.confidence <= 1
        sure &= 0 <= gesture.novelty <= (EMERGENCY_LIMIT if is_emergency else math.inf)
        before = self._gestures.get(gesture.body_id, Shown())
        is_newer = gesture.stamp > before.stamp
        if sure and gesture.label in self.rules.cancel:
            refused = None
        elif sure and is_emergency:
            refused = self._find_foreign(gesture, self.rules.emergency_seconds)
        else:
            refused = self._find_refusal(gesture, before, is_newer=is_newer)
        if refused is not None:
            return Decision(refused)
        label, pair = (gesture.label, gesture.pair) if sure else (None, None)
        understood = label is not None or pair is not None
        self._remember(self._gestures, gesture, understood=understood)
        if label is not None:
            return self._decide_label(label, gesture)
        if pair is not None:
            return self._decide_pair(pair, gesture)
        return Decision("not understood; show the gesture again", reply=Reply.refused)

    def decide_phrase(self, phrase: RecognizedPhrase, now: float) -> Decision:
        """Decide about a phrase event, which follows a gesture or a pause.

        Parameters
        ----------
        phrase
            Result of the language's grammar.
        now
            Current time in seconds, in the clock of the stamps.

        """
        self._follow_clock(now)
        before = self._messages.get(phrase.body_id, Shown())
        # One picture can end a message and begin another one: two events with the same stamp.
        is_newer = (phrase.stamp, phrase.start) > (before.stamp, before.started)
        whole = phrase.kind == "complete"
        refused = None
        if phrase.kind != "cancelled":
            same = before if whole else replace(before, middle=-math.inf)
            refused = self._find_refusal(phrase, same, is_newer=is_newer)
        if refused is None and not self.table.phrase_labels:
            refused = "ignored: the language of the commands has no phrases"
        if refused is not None:
            return Decision(refused)
        self._remember(self._messages, phrase, understood=whole)
        pending = self.pending if self.pending and self.pending.mission else None
        repeated = self._find_repeated(pending, phrase)
        if phrase.kind == "complete" and phrase.mission:
            return self._complete(phrase, repeated)
        if phrase.kind == "continues" and repeated:
            self.pending = replace(repeated, deadline=phrase.stamp + self.rules.confirm_seconds)
        stays = phrase.kind in ("continues", "repeat")
        stays |= phrase.kind == "outside" and phrase.label is None
        reply = find_phrase_reply(phrase.kind, phrase.label, phrase.pair)
        if pending is None or stays:
            if phrase.pair is not None and self.rules.emergency.intersection(phrase.pair):
                return self._ask(phrase.pair)
            return Decision(phrase.text, reply=reply)
        self.pending = None
        return Decision(f"{phrase.text}; {pending.label!r} is forgotten", reply=reply)

    def check_deadline(self, now: float) -> Decision | None:
        """Clear the pending gesture or message after its deadline.

        Parameters
        ----------
        now
            Current time in seconds, in the clock of the stamps.

        Returns
        -------
        The decision, or None for no change. The deadline is extended by `stale_seconds`, because a
        repetition that ended in time may arrive that late.

        """
        self._follow_clock(now)
        pending = self.pending
        if pending is None or now <= pending.deadline + self.rules.stale_seconds:
            return None
        self.pending = None
        words = f"{pending.label!r} was not repeated in time; show it twice"
        return Decision(words, reply=Reply.refused)

    def _follow_clock(self, now: float) -> None:
        """Store the time; when the clock was set back, shift all stored times with it."""
        step = now - self._now
        if math.isfinite(step) and step < 0:
            if self.pending is not None:
                self.pending = replace(self.pending, deadline=self.pending.deadline + step)
            for shown in (self._gestures, self._messages):
                for body, last in shown.items():
                    shown[body] = Shown(last.stamp + step, last.started + step, last.middle + step)
        self._now = to_number(now)

    def _remember(self, shown: dict[str, Shown], showing: Showing, *, understood: bool) -> None:
        """Store the last event of a body."""
        last = shown.pop(showing.body_id, Shown())
        # A stamp in the future must not make later events count as old.
        stamp = self._now if math.isnan(showing.stamp) else min(showing.stamp, self._now)
        middle = (showing.began + stamp) / 2 if understood else last.middle
        shown[showing.body_id] = Shown(
            max(stamp, last.stamp), max(min(showing.began, stamp), last.started), middle
        )
        if len(shown) > MOST_BODIES:
            del shown[next(iter(shown))]

    def _find_refusal(self, showing: Showing, before: Shown, *, is_newer: bool) -> str | None:
        """Return why a gesture or message is ignored; None where it is not."""
        what = showing.noun
        if refused := self._find_foreign(showing, self.rules.stale_seconds):
            return refused
        if not is_newer:
            return f"ignored: the {what} is not newer than the one before"
        if showing.began < before.middle:
            return f"ignored: the {what} is the one before, recognised once more"
        return None

    def _find_foreign(self, showing: Showing, oldest: float) -> str | None:
        """Return why a gesture or message is not of here and now; None where it is."""
        what, age = showing.noun, self._now - showing.stamp
        if math.isnan(showing.stamp + showing.began):
            return f"ignored: the {what} has no stamp"
        if not abs(age) <= oldest:
            return f"ignored: the {what} is stamped {age:.1f} s ago, stale or of another clock"
        if showing.language_id != self.table.language_id:
            return f"ignored: the {what} is of another language than the commands"
        return None

    def _find_repeated(self, pending: Pending | None, showing: Showing) -> Pending | None:
        """Return what is confirmed, if it was shown in time, and by the same body."""
        if pending is None or not showing.stamp <= pending.deadline:
            return None
        return pending if showing.body_id == pending.body_id else None

    def _decide_label(self, label: str, gesture: RecognizedGesture) -> Decision:
        pending, self.pending = self.pending, None
        command = self.table.commands.get(label)
        if label in self._phrase_only:
            # Such gestures repeat the pending message.
            self.pending = pending if pending and pending.mission else None
            return Decision(f"{label!r} counts within a phrase only", label=label)
        if label in self.rules.cancel:
            what = f"{pending.label!r} is cancelled" if pending else "nothing to cancel"
            return Decision(what, label=label, cancels=True, reply=Reply.done)
        if command is None:
            return Decision(f"{label!r} has no command", label=label, reply=Reply.refused)
        if label in self.rules.emergency:
            return Decision(f"emergency {label!r}: {command}", command, label, emergency=True)
        repeated = self._find_repeated(pending, gesture)
        if not self.rules.confirmed or (repeated and label in repeated.labels):
            return Decision(f"{label!r}: {command}", command, label)
        deadline = gesture.stamp + self.rules.confirm_seconds
        self.pending = Pending(label, deadline, body_id=gesture.body_id, labels=(label,))
        words = f"repeat {label!r} to confirm: {command}"
        return Decision(words, label=label, reply=Reply.repeat)

    def _decide_pair(self, pair: tuple[str, str], gesture: RecognizedGesture) -> Decision:
        """Ask which of two gestures was meant; the next showing decides, and confirms."""
        pending = self.pending
        if (pending and pending.mission) or self._phrase_only.issuperset(pair):
            return self._ask(pair)
        self.pending = None
        if not {*self.table.commands, *self.rules.cancel}.intersection(pair):
            named = " and ".join(map(repr, pair))
            return Decision(f"{named} have no command", reply=Reply.refused)
        repeated = self._find_repeated(pending, gesture)
        if repeated and repeated.asked:
            return Decision("not understood; begin again", reply=Reply.refused)
        # What was shown alone before is confirmed by itself only.
        before = () if repeated is None else repeated.labels
        labels = tuple(each for each in pair if each in before) or pair
        deadline = gesture.stamp + self.rules.confirm_seconds
        label = " or ".join(labels)
        self.pending = Pending(label, deadline, None, gesture.body_id, labels, asked=True)
        return self._ask(pair)

    def _ask(self, pair: tuple[str, str]) -> Decision:
        """Ask which gesture was meant, with an emergency first."""
        named = sorted(pair, key=lambda each: each not in self.rules.emergency)
        return Decision(f"{' or '.join(named)}? show it again", reply=Reply.one_of_two)

    @property
    def _phrase_only(self) -> frozenset[str]:
        """Labels that have no meaning alone."""
        return self.table.phrase_labels - self.rules.cancel - self.rules.emergency

    def _complete(self, phrase: RecognizedPhrase, pending: Pending | None) -> Decision:
        """Decide about a complete message, which may confirm `pending`."""
        # True for NaN too: what is no share of 1 is no confidence.
        if not self.rules.least_confidence <= phrase.confidence <= 1:
            return Decision("not understood; show the message again", reply=Reply.refused)
        self.pending = None
        if not self.rules.confirmed or (pending and pending.mission == phrase.mission):
            return Decision(phrase.text, phrase.mission, phrase.text)
        deadline = phrase.stamp + self.rules.confirm_seconds
        self.pending = Pending(phrase.text, deadline, phrase.mission, phrase.body_id)
        words = f"repeat the message to confirm: {phrase.text}"
        return Decision(words, label=phrase.text, reply=Reply.repeat)
