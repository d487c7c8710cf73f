"""Grammar parts: what a grammar consists of, before it is validated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from app.recognition.phrases.phrase import Group, OneOf, Part, Phrase, SlotType
from app.recognition.text.strict_json import build_pointer

DEFAULT_TIMEOUT = 10.0
"""Seconds: how long attention stays with a dialogue without answer (Nielsen 1993)."""

FRAME = ("start", "end", "cancel")
"""Roles of the gestures around a message."""


@dataclass(frozen=True)
class Use:
    """A reference to a gesture in a grammar.

    Attributes
    ----------
    label
        The gesture's.
    pointer
        JSON pointer into the language file.
    where
        The place in words.
    role
        One of `FRAME`; None inside a phrase or a slot type.

    """

    label: str
    pointer: str
    where: str
    role: str | None = None


@dataclass(frozen=True)
class GrammarParts:
    """The phrases of a language, with its start, end and cancel gestures and time-out.

    Attributes
    ----------
    phrases
        In the author's order.
    slot_types
        The types of slots.
    start, end
        Labels of the gestures that open and close a message; None: none is needed.
    cancel
        Label of the gesture that drops an unfinished message.
    timeout
        Most seconds between the end of a gesture and the start of the next one of a message.
    most_phrases
        Phrases in one message, one after the other, each opened by `start`.

    """

    phrases: tuple[Phrase, ...] = ()
    slot_types: tuple[SlotType, ...] = ()
    start: str | None = None
    end: str | None = None
    cancel: str | None = None
    timeout: float = DEFAULT_TIMEOUT
    most_phrases: int = 1

    def slot_type(self, name: str) -> SlotType:
        """Return the slot type of that name, which must exist."""
        return next(each for each in self.slot_types if each.name == name)

    def uses(self) -> Iterator[Use]:
        """Yield every reference to a gesture, in the file's order."""
        for role in FRAME:
            label = getattr(self, role)
            if label is not None:
                yield Use(label, build_pointer("grammar", role), f"the {role} gesture", role)
        for index, slot_type in enumerate(self.slot_types):
            for number, label in enumerate(slot_type.values):
                pointer = build_pointer("grammar", "slot_types", index, "values", number, "gesture")
                yield Use(label, pointer, f"the slot type {slot_type.name!r}")
        for index, phrase in enumerate(self.phrases):
            place = build_pointer("grammar", "phrases", index, "parts")
            for pointer, label in _labels_in(phrase.parts, place):
                yield Use(label, pointer, f"the phrase {phrase.name!r}")


def _labels_in(parts: Sequence[Part], place: str) -> Iterator[tuple[str, str]]:
    for index, part in enumerate(parts):
        at = place + build_pointer(index)
        if isinstance(part, OneOf):
            for number, label in enumerate(part.gestures):
                yield at + build_pointer("gestures", number), label
        elif isinstance(part, Group):
            yield from _labels_in(part.parts, at + "/parts")
