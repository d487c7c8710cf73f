"""Interpretation: the command, values and spoken text of each phrase of a parsed message."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from app.recognition.phrases.automaton import Parse
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import Phrase, Slot, Value
from app.recognition.phrases.templates import (
    SlotValue,
    fill_template,
    find_whole_placeholder,
    speak_template,
    speak_value,
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
    """Fill the placeholders of a command, at any depth, with values."""
    if isinstance(command, dict):
        return {key: _fill(each, values) for key, each in command.items()}
    if isinstance(command, list):
        return [_fill(each, values) for each in command]
    if not isinstance(command, str):
        return command
    whole = find_whole_placeholder(command)
    return fill_template(command, values) if whole is None else values[whole]
