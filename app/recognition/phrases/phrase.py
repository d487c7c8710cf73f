"""Phrases: sequences of parts (gestures, slots, groups) with a command and a spoken text.

Text templates with ``{slot}`` placeholders, and optional text in ``[ ]``.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Set
from dataclasses import dataclass
from typing import Any, Literal

from app.recognition.text.wording import join_words

MAX_REPEAT = 10
"""Most repetitions of one part: more are hard to count while swimming."""

Value = str | int | float
"""The value of a gesture in a slot."""

ReadsAs = Literal["number", "text", "digits"]
"""How a slot's gestures are read: a number each, a text each, or together as a decimal number."""


@dataclass(frozen=True)
class OneOf:
    """A part that is one of several gestures, without value.

    Attributes
    ----------
    gestures
        Labels of the alternatives.
    least, most
        Repetitions; ``least`` 0: optional.
    """

    gestures: tuple[str, ...]
    least: int = 1
    most: int = 1


@dataclass(frozen=True)
class Slot:
    """A part whose gesture gives a value for the command.

    Attributes
    ----------
    name
        Name of the value in command and spoken text.
    slot_type
        Name of the `SlotType` whose gestures may fill it.
    least, most
        Repetitions; ``least`` 0: optional. More than one makes the value a list, or one number
        where the type reads digits.
    default
        The command's value where the slot was left out; None: none.

    """

    name: str
    slot_type: str
    least: int = 1
    most: int = 1
    default: Value | None = None


@dataclass(frozen=True)
class Group:
    """Parts that are optional or repeated together; a group contains no groups."""

    parts: tuple[OneOf | Slot, ...]
    least: int = 1
    most: int = 1


Part = OneOf | Slot | Group


@dataclass(frozen=True)
class SlotType:
    """The gestures that may fill a slot, with their values.

    Attributes
    ----------
    name
        Name in `Slot.slot_type`.
    reads_as
        Kind of the values.
    values
        Value by label, in the author's order.

    """

    name: str
    reads_as: ReadsAs
    values: Mapping[str, Value]


@dataclass(frozen=True)
class Phrase:
    """Sequences of gestures with one meaning.

    Attributes
    ----------
    name
        Of the phrase; unique in its grammar.
    parts
        In the order in which they are shown.
    command
        What the robot should do: text, an object, or None; ``{slot}`` in it is replaced by the
        value.
    says
        Spoken text: ``{slot}`` is replaced by the value, and text in ``[ ]`` is left out if its
        slots are. Empty: the name and the values.

    """

    name: str
    parts: tuple[Part, ...]
    command: str | dict[str, Any] | None = None
    says: str = ""

    def slots(self) -> Iterator[tuple[Slot, Group | None]]:
        """Yield every slot with the group that contains it, if any."""
        for part in self.parts:
            if isinstance(part, Slot):
                yield part, None
            elif isinstance(part, Group):
                yield from ((member, part) for member in part.parts if isinstance(member, Slot))


SlotValue = Value | list[Value]
"""Value of a slot: a list if it may be filled more than once."""

_PLACEHOLDER = re.compile(r"\{([a-z][a-z0-9_]*)\}")
_STRETCH = re.compile(r"\[([^\[\]]*)\]|([^\[\]]+)")


def find_placeholders(text: str) -> Iterator[str]:
    """Yield the slots that a text refers to."""
    return (match[1] for match in _PLACEHOLDER.finditer(text))


def find_template_fault(
    template: str, slots: Collection[str], missing: Collection[str]
) -> str | None:
    """Return what is wrong with a spoken text, or None.

    Parameters
    ----------
    template
        The text.
    slots
        Names of the slots.
    missing
        Slots that may have no value: they must be in ``[ ]``.

    """
    if _STRETCH.sub("", template):
        return f"the square brackets in {template!r} do not pair up, or are nested"
    for optional, plain in _STRETCH.findall(template):
        names = list(find_placeholders(optional or plain))
        if unknown := [name for name in names if name not in slots]:
            return (
                f"{{{unknown[0]}}} is no slot here; there is {', '.join(sorted(slots)) or 'none'}"
            )
        if optional and not names:
            return f"[{optional}] has no slot in it that could be left out: write it without [ ]"
        if absent := [name for name in names if plain and name in missing]:
            return f"{{{absent[0]}}} may be left out: put the text that depends on it in [ ]"
    return None


def fill_template(text: str, values: Mapping[str, SlotValue | None]) -> str:
    """Replace the placeholders of a text by values in words; missing values by nothing."""
    return _PLACEHOLDER.sub(lambda match: speak_value(values.get(match[1])), text)


def find_whole_placeholder(text: str) -> str | None:
    """Return the slot if a text is just its placeholder, else None."""
    match = _PLACEHOLDER.fullmatch(text)
    return match[1] if match else None


def speak_template(template: str, values: Mapping[str, SlotValue | None], shown: Set[str]) -> str:
    """Return a spoken text with values.

    Parameters
    ----------
    template
        A spoken text.
    values
        By slot.
    shown
        The slots that a gesture filled: text in ``[ ]`` without any of them is left out.

    """
    return "".join(
        fill_template(optional or plain, values)
        for optional, plain in _STRETCH.findall(template)
        if plain or shown >= set(find_placeholders(optional))
    )


def speak_value(value: SlotValue | None) -> str:
    """Return a value in words."""
    if value is None:
        return ""
    if isinstance(value, list):
        return join_words([speak_value(each) for each in value])
    return str(value).removesuffix(".0") if isinstance(value, float) else str(value)
