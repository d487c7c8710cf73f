"""Phrases: sequences of parts (gestures, slots, groups) with a command and a spoken text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

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
