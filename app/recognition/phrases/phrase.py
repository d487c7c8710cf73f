"""A phrase: the parts shown one after the other, its slots, and what it tells the robot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

MAX_REPEAT = 10
"""Most gestures in a row for one part: nobody counts further while swimming."""

Value = str | int | float
"""What a gesture stands for in a slot."""

ReadsAs = Literal["number", "text", "digits"]
"""How a slot's gestures are read: a number each, a text each, or together as a decimal number."""


@dataclass(frozen=True)
class OneOf:
    """One gesture out of some, which says nothing more.

    Attributes
    ----------
    gestures
        Labels, any of which will do.
    least, most
        How often in a row; ``least`` 0: it may be left out.

    """

    gestures: tuple[str, ...]
    least: int = 1
    most: int = 1


@dataclass(frozen=True)
class Slot:
    """A gesture that carries a value for the command.

    Attributes
    ----------
    name
        By which command and spoken text refer to the value.
    slot_type
        Name of the `SlotType` whose gestures may stand here.
    least, most
        How often in a row; ``least`` 0: it may be left out. More than one makes the value a list,
        or one number where the type reads digits.
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
    """Parts that are left out or repeated together; a group holds no groups."""

    parts: tuple[OneOf | Slot, ...]
    least: int = 1
    most: int = 1


Part = OneOf | Slot | Group


@dataclass(frozen=True)
class SlotType:
    """The gestures that may fill a slot, and what each stands for.

    Attributes
    ----------
    name
        By which slots refer to it.
    reads_as
        What kind of values they are.
    values
        Value per label, in the author's order.

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
        What the robot should do: text, an object, or None; ``{slot}`` in it stands for a value.
    says
        How it is spoken back: ``{slot}`` stands for a value, and what is in ``[ ]`` is left out
        with the slots in it. Empty: the name and the values.

    """

    name: str
    parts: tuple[Part, ...]
    command: str | dict[str, Any] | None = None
    says: str = ""

    def slots(self) -> Iterator[tuple[Slot, Group | None]]:
        """Give every slot, with the group that it is in."""
        for part in self.parts:
            if isinstance(part, Slot):
                yield part, None
            elif isinstance(part, Group):
                yield from ((member, part) for member in part.parts if isinstance(member, Slot))
