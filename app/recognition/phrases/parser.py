"""Phrase parser: parses messages gesture by gesture, and gives what they mean.

`PhraseParser` lists what may come next. Errors are handled as in CADDIAN (Chiarella et al. 2018): a
gesture that was not recognised, or that lies between two, is repeated and the sequence kept; one
that cannot follow ends the message; and a message is read back, so that the diver can cancel it.
`interpret_message` returns the command, values and spoken text of each phrase of a parsed message.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from app.recognition.phrases.automaton import BEFORE, Parse, PhraseAutomaton
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import (
    Phrase,
    Slot,
    SlotValue,
    Value,
    fill_template,
    find_whole_placeholder,
    speak_template,
    speak_value,
)
from app.recognition.text.wording import ask_which, join_words

PhraseEventKind = Literal[
    "continues",
    "complete",
    "ambiguous",
    "cancelled",
    "timed_out",
    "unexpected",
    "repeat",
    "outside",
]

CancelReason = Literal["cancel_gesture", "lost_source", "end", "new_language"]
"""Why a message is cancelled: by its diver, or because camera or diver were lost, the source ended,
or another language was loaded."""

ENOUGH = 2
"""Parses kept for a position: with two the message is ambiguous, whatever a third is."""


@dataclass(frozen=True, kw_only=True)
class PhraseEvent:
    """The effect of a gesture or a pause on the message.

    Attributes
    ----------
    kind
        ``continues``: the message needs or allows further gestures. ``complete``: the message
        ended. ``ambiguous``: it ended with two meanings, so there is no command. ``cancelled``,
        ``timed_out``, ``unexpected``: it is dropped. ``repeat``: the gesture was not recognised, or
        `pair` is asked; the message is kept. ``outside``: no message has begun.
    gestures
        Labels of the message so far, including this gesture if it belongs to it.
    label
        Label of this gesture; None for a pair, when it was rejected, and for a pause.
    pair
        The two gestures between which this one lies, asked at the place after `gestures`; None
        otherwise, and for a second pair in a row, which counts as rejected.
    expected
        Labels that may come next, in the grammar's order.
    mission
        The meaning of the message; only when complete.
    reason
        Why the message is cancelled; only then.
    start, end
        Seconds at which the message so far starts and ends, in the clock of the gestures.

    """

    kind: PhraseEventKind
    gestures: tuple[str, ...]
    label: str | None
    pair: tuple[str, str] | None = None
    expected: tuple[str, ...]
    mission: Mission | None = None
    reason: CancelReason | None = None
    start: float
    end: float

    @property
    def text(self) -> str:
        """The event as a sentence for the diver."""
        so_far, following = ", ".join(self.gestures), join_words(self.expected, last="or")
        if self.mission is not None:
            return self.mission.spoken
        if self.pair is not None:
            place = f"gesture {len(self.gestures) + 1}: " if self.gestures else ""
            return f"{place}{ask_which(self.pair)} show it again"
        return {
            "continues": f"{so_far}: then {following}",
            "complete": so_far,
            "ambiguous": f"{so_far} has two meanings; nothing is done",
            "cancelled": {
                "lost_source": f"{so_far}: the camera lost the diver; begin again",
                "end": f"{so_far}: the recording ends before the message",
                "new_language": f"{so_far}: another language was loaded; begin again",
            }.get(self.reason or "", "cancelled"),
            "timed_out": f"{so_far}: waited too long for {following}; begin again",
            "unexpected": f"{self.label} does not follow {so_far}, {following} does; begin again",
            "repeat": f"not recognised, show it again: {following}",
            "outside": f"{self.label or 'not recognised'}: no message has begun; {following} does",
        }[self.kind]

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        plain = {
            key: [*each] if isinstance(each, tuple) else each for key, each in vars(self).items()
        }
        mission = None if self.mission is None else self.mission.to_list()
        return plain | {"mission": mission, "text": self.text}


@dataclass(frozen=True)
class _Message:
    """An unfinished message.

    Attributes
    ----------
    parses
        Its parses by the position of the automaton that they lead to.
    gestures
        Labels.
    start, end
        Seconds, of its first and its last gesture.
    doubtful
        Whether the last gesture was not recognised.
    asked
        Whether a pair was asked since the last gesture that was recognised.

    """

    parses: Mapping[int, tuple[Parse, ...]] = field(default_factory=lambda: {BEFORE: ((),)})
    gestures: tuple[str, ...] = ()
    start: float = 0.0
    end: float = 0.0
    doubtful: bool = False
    asked: bool = False


class PhraseParser:
    """Parses recognised gestures into messages.

    Only a message with exactly one parse gives a command, if all its gestures were recognised and
    followed each other within the grammar's time-out. Where a message could end or continue, which
    the check of the language reports, the time-out ends it.

    Parameters
    ----------
    grammar
        The language's.

    """

    def __init__(self, grammar: Grammar) -> None:
        self.grammar = grammar
        self._automaton = PhraseAutomaton(grammar)
        self._labels = tuple(dict.fromkeys(use.label for use in grammar.uses()))
        self._message = _Message()

    @property
    def expected(self) -> tuple[str, ...]:
        """Labels that may come next, in the grammar's order."""
        possible = {
            label for position in self._message.parses for label in self._automaton.moves[position]
        }
        return tuple(label for label in self._labels if label in possible)

    @property
    def may_end(self) -> bool:
        """Whether a pause now would complete the message instead of dropping it."""
        return not self._message.doubtful and len(self._complete()) == 1

    def feed(
        self, label: str | None, start: float, end: float, pair: tuple[str, str] | None = None
    ) -> tuple[PhraseEvent, ...]:
        """Process one gesture.

        Parameters
        ----------
        label
            As recognised; None for a pair, and when it was rejected.
        start, end
            Seconds of the take, in one clock for all gestures.
        pair
            The two gestures between which the take lies, if there is no label.

        Returns
        -------
        The event of the gesture; before it, that of the preceding pause if it was too long.

        """
        return (*self.expire(start), *self._advance(label, start, end, pair))

    def expire(self, now: float) -> tuple[PhraseEvent, ...]:
        """Process a pause: no gesture had begun by `now`; returns an event if it is too long."""
        message = self._message
        if not message.gestures or now - message.end <= self.grammar.timeout:
            return ()
        # After a gesture that was not recognised it is unknown whether the message had ended.
        if not message.doubtful and (parses := self._complete()):
            return (self._end_message(None, parses),)
        return (self._drop("timed_out", None),)

    def abandon(self, reason: CancelReason) -> tuple[PhraseEvent, ...]:
        """Drop an unfinished message for a reason that is not its diver's."""
        if not self._message.gestures:
            return ()
        return (replace(self._drop("cancelled", None), reason=reason),)

    def _advance(
        self, label: str | None, start: float, end: float, pair: tuple[str, str] | None = None
    ) -> tuple[PhraseEvent, ...]:
        last = self._message
        before = last if last.gestures else _Message(start=start)
        self._message = replace(before, end=end, doubtful=label is None, asked=False)
        if label is None:
            asked = last.asked and start - last.end <= self.grammar.timeout
            told = self._event("repeat" if before.gestures else "outside", None)
            # A second pair clears the question, another rejected gesture keeps it.
            self._message = replace(self._message, asked=asked != (pair is not None))
            return (told if asked else replace(told, pair=pair),)
        if before.gestures and label == self.grammar.cancel:
            return (replace(self._drop("cancelled", label), reason="cancel_gesture"),)
        following = self._following(label)
        if not following:
            return self._handle_unexpected(label, start, end)
        gestures = (*before.gestures, label)
        self._message = _Message(following, gestures, before.start, end)
        if not any(self._automaton.moves[position] for position in following):
            return (self._end_message(label, self._complete()),)
        return (self._event("continues", label),)

    def _handle_unexpected(self, label: str, start: float, end: float) -> tuple[PhraseEvent, ...]:
        """Handle a gesture that cannot follow; the start gesture begins a new message."""
        if not self._message.gestures:
            return (self._event("outside", label),)
        dropped = self._drop("unexpected", label)
        restarted = self._advance(label, start, end) if label == self.grammar.start else ()
        return (dropped, *restarted)

    def _following(self, label: str) -> dict[int, tuple[Parse, ...]]:
        """Return the parses of the message with one more gesture, by position."""
        following: dict[int, tuple[Parse, ...]] = {}
        for position, parses in self._message.parses.items():
            for target, added in self._automaton.moves[position].get(label, ()):
                known = following.get(target, ())
                more = [*known, *(parse + added for parse in parses)]
                following[target] = tuple(dict.fromkeys(more))[:ENOUGH]
        return following

    def _complete(self) -> tuple[Parse, ...]:
        """Return the parses with which the message could end now."""
        found = [
            parse
            for position, parses in self._message.parses.items()
            if position in self._automaton.accepting
            for parse in parses
        ]
        return tuple(dict.fromkeys(found))

    def _end_message(self, label: str | None, parses: tuple[Parse, ...]) -> PhraseEvent:
        if len(parses) > 1:
            return self._drop("ambiguous", label)
        return self._drop("complete", label, interpret_message(self.grammar, parses[0]))

    def _drop(
        self, kind: PhraseEventKind, label: str | None, mission: Mission | None = None
    ) -> PhraseEvent:
        """Drop the message."""
        event = self._event(kind, label, mission)
        self._message = _Message()
        # After a time-out the expected gestures of this message, otherwise those of the next one.
        in_vain = kind in ("timed_out", "unexpected")
        return event if in_vain else replace(event, expected=self.expected)

    def _event(
        self, kind: PhraseEventKind, label: str | None, mission: Mission | None = None
    ) -> PhraseEvent:
        return PhraseEvent(
            kind=kind,
            gestures=self._message.gestures,
            label=label,
            expected=self.expected,
            mission=mission,
            start=self._message.start,
            end=self._message.end,
        )


@dataclass(frozen=True)
class Meaning:
    """The meaning of one phrase of a message.

    Attributes
    ----------
    phrase
        Its name.
    slots
        Values of the slots that were filled, by name.
    command
        The phrase's command with values for ``{slot}``; a slot that is the whole text keeps its
        JSON type, and is null where it was left out without a default.
    spoken
        Text that is read back to the diver.

    """

    phrase: str
    slots: Mapping[str, SlotValue]
    command: str | dict[str, Any] | None
    spoken: str

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return vars(self) | {"slots": dict(self.slots)}


@dataclass(frozen=True)
class Mission:
    """The meaning of one message: its phrases in order."""

    phrases: tuple[Meaning, ...]

    @property
    def spoken(self) -> str:
        """Text that is read back to the diver, who can then cancel a wrong mission."""
        return f"mission: {'; then '.join(meaning.spoken for meaning in self.phrases)}"

    def to_list(self) -> list[dict[str, Any]]:
        """Return plain JSON types."""
        return [meaning.to_dict() for meaning in self.phrases]


def interpret_message(grammar: Grammar, parse: Parse) -> Mission:
    """Return the mission of a parse."""
    shown: list[tuple[Phrase, dict[str, list[Value]]]] = []
    for each in parse:
        if each.slot is None:
            shown.append((grammar.phrases[each.phrase], {}))
        elif each.value is not None:
            shown[-1][1].setdefault(each.slot, []).append(each.value)
    return Mission(tuple(_meaning(grammar, phrase, values) for phrase, values in shown))


def _meaning(grammar: Grammar, phrase: Phrase, values: Mapping[str, list[Value]]) -> Meaning:
    shown: dict[str, SlotValue] = {}
    known: dict[str, SlotValue | None] = {}
    for slot, group in phrase.slots():
        if slot.name in values:
            repeated = slot.most > 1 or (group is not None and group.most > 1)
            shown[slot.name] = _value(grammar, slot, values[slot.name], repeated=repeated)
        known[slot.name] = shown.get(slot.name, slot.default)
    if isinstance(phrase.command, str):
        command: str | dict[str, Any] | None = fill_template(phrase.command, known)
    else:
        command = _fill(phrase.command, known)
    if phrase.says:
        spoken = speak_template(phrase.says, known, shown.keys())
    else:
        values_told = (f"{name} {speak_value(value)}" for name, value in shown.items())
        spoken = ", ".join([phrase.name, *values_told])
    return Meaning(phrase.name, shown, command, spoken)


def _value(grammar: Grammar, slot: Slot, values: list[Value], *, repeated: bool) -> SlotValue:
    if grammar.slot_type(slot.slot_type).reads_as == "digits":
        return int("".join(map(str, values)))
    return values if repeated else values[0]


def _fill(command: Any, values: Mapping[str, SlotValue | None]) -> Any:
    """Fill the placeholders of a command, at any depth, with values.

    A text that is nothing but a placeholder becomes the value itself, with its type.
    """
    if isinstance(command, dict):
        return {key: _fill(each, values) for key, each in command.items()}
    if isinstance(command, list):
        return [_fill(each, values) for each in command]
    if not isinstance(command, str):
        return command
    whole = find_whole_placeholder(command)
    return fill_template(command, values) if whole is None else values[whole]
