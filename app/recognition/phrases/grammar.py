"""Grammar: the phrases of a language, which are sequences of gestures with one command.

Modelled on CADDIAN (Chiarella et al. 2015, 2018): messages have start and end gestures, and phrases
have slots for quantities. Every repetition is bounded, so there are finitely many sequences and
ambiguities can be found exactly, see `phrase_ambiguity`. `check_phrases` applies the rules beyond
the schema; each error has its JSON pointer.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from app.recognition.errors import LanguageError, point_to
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH, MAX_TEXT_LENGTH, check_command
from app.recognition.phrases.phrase import (
    MAX_REPEAT,
    Group,
    OneOf,
    Part,
    Phrase,
    Slot,
    SlotType,
    Value,
    find_placeholders,
    find_template_fault,
)
from app.recognition.text.look_alikes import is_printable, without_joiners
from app.recognition.text.strict_json import build_pointer

DEFAULT_TIMEOUT = 10.0
"""Seconds: how long attention stays with a dialogue without answer (Nielsen 1993)."""

MAX_TIMEOUT = 600.0
"""Seconds: ten minutes, far longer than any pause within a message."""

MAX_PHRASES_IN_MESSAGE = 8
"""Most phrases of a message. CADDIAN's missions have up to eleven commands; longer ones are planned
on the surface."""

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
class Grammar:
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

    Raises
    ------
    LanguageError
        When it is inconsistent; the pointer is that of the language file.

    """

    phrases: tuple[Phrase, ...] = ()
    slot_types: tuple[SlotType, ...] = ()
    start: str | None = None
    end: str | None = None
    cancel: str | None = None
    timeout: float = DEFAULT_TIMEOUT
    most_phrases: int = 1

    def __post_init__(self) -> None:
        """Validate the grammar."""
        self._check_frame()
        check_phrases(self.phrases, self.slot_types)
        self._check_cancel()

    def _check_frame(self) -> None:
        if not 0 < self.timeout <= MAX_TIMEOUT:  # NaN is not either
            raise LanguageError(
                f"must be above 0 and at most {MAX_TIMEOUT:g} seconds, got {self.timeout}",
                "/grammar/timeout",
            )
        if not 1 <= self.most_phrases <= MAX_PHRASES_IN_MESSAGE:
            raise LanguageError(
                f"must be 1 to {MAX_PHRASES_IN_MESSAGE}, got {self.most_phrases}",
                "/grammar/most_phrases",
            )
        if self.most_phrases > 1 and self.end is None:
            raise LanguageError(
                "a message of several phrases needs an end gesture: without one the robot cannot "
                "detect its end",
                "/grammar/most_phrases",
            )

    def _check_cancel(self) -> None:
        for use in self.uses():
            if use.label == self.cancel and use.role != "cancel":
                raise LanguageError(
                    f"{use.label!r} is the cancel gesture, so {use.where} cannot use it: choose "
                    "another gesture",
                    use.pointer,
                )

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

    def require(self, labels: Collection[str]) -> None:
        """Check that a language has all gestures of the grammar.

        Raises
        ------
        LanguageError
            When a gesture is missing; its pointer is that of the language file.

        """
        for use in self.uses():
            if use.label not in labels:
                raise LanguageError(
                    f"{use.where} needs a gesture {use.label!r}, which the language does not "
                    f"have; it has {', '.join(sorted(labels)) or 'none'}",
                    use.pointer,
                )

    def users_of(self, label: str) -> tuple[str, ...]:
        """Return the phrases and other places that need a gesture, in words, each once.

        A phrase with a slot needs the gestures of the slot's type as well.
        """
        named = {use.where: None for use in self.uses() if use.label == label}
        filled = {each.name for each in self.slot_types if label in each.values}
        for phrase in self.phrases:
            if any(slot.slot_type in filled for slot, _ in phrase.slots()):
                named[f"the phrase {phrase.name!r}"] = None
        return tuple(named)

    def renamed(self, before: str, after: str) -> Grammar:
        """Return the grammar in which a gesture has another label."""

        def name(label: str) -> str:
            return after if label == before else label

        def part(each: Part) -> Part:
            if isinstance(each, OneOf):
                return replace(each, gestures=tuple(map(name, each.gestures)))
            if isinstance(each, Group):
                # No group is dropped: a group contains none, which only the type checker is told.
                members = [part(member) for member in each.parts]
                return replace(each, parts=tuple(m for m in members if not isinstance(m, Group)))
            return each

        def slot_type(each: SlotType) -> SlotType:
            return replace(each, values={name(label): v for label, v in each.values.items()})

        def phrase(each: Phrase) -> Phrase:
            return replace(each, parts=tuple(map(part, each.parts)))

        return replace(
            self,
            start=self.start and name(self.start),
            end=self.end and name(self.end),
            cancel=self.cancel and name(self.cancel),
            slot_types=tuple(map(slot_type, self.slot_types)),
            phrases=tuple(map(phrase, self.phrases)),
        )

    def example(self, phrase: Phrase) -> tuple[str, ...]:
        """Return a message of one phrase with all its parts."""
        opening = () if self.start is None else (self.start,)
        closing = () if self.end is None else (self.end,)
        return (*opening, *self._example_of(phrase.parts), *closing)

    def _example_of(self, parts: Sequence[Part]) -> Iterator[str]:
        for part in parts:
            for _ in range(max(part.least, 1)):
                if isinstance(part, Group):
                    yield from self._example_of(part.parts)
                elif isinstance(part, Slot):
                    yield next(iter(self.slot_type(part.slot_type).values))
                else:
                    yield part.gestures[0]


def _labels_in(parts: Sequence[Part], place: str) -> Iterator[tuple[str, str]]:
    for index, part in enumerate(parts):
        at = place + build_pointer(index)
        if isinstance(part, OneOf):
            for number, label in enumerate(part.gestures):
                yield at + build_pointer("gestures", number), label
        elif isinstance(part, Group):
            yield from _labels_in(part.parts, at + "/parts")


MAX_PHRASES = 100
"""Five times the longest list that divers were taught (CADDIAN: 40 commands and few variants)."""

MAX_GESTURES_IN_PHRASE = 40
"""Most gestures of a phrase, with every repetition counted: bounds the work of the check, and a
phrase of forty gestures takes minutes to show."""

MAX_GESTURES_IN_GRAMMAR = 1000
"""Most gestures of all phrases together, for the same reason: the check compares each with each."""

SLOT_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")
"""Name of a placeholder, which is also a valid parameter name on any robot."""


def check_phrases(phrases: Sequence[Phrase], slot_types: Sequence[SlotType]) -> None:
    """Check that the phrases of a grammar, and the types of their slots, are consistent.

    Raises
    ------
    LanguageError
        Its pointer is that of the language file.

    """
    if len(phrases) > MAX_PHRASES:
        raise LanguageError(
            f"{len(phrases)} phrases, the limit is {MAX_PHRASES}", "/grammar/phrases"
        )
    _check_names((each.name for each in slot_types), "slot_types")
    _check_names((each.name for each in phrases), "phrases")
    for index, slot_type in enumerate(slot_types):
        _check_slot_type(slot_type, build_pointer("grammar", "slot_types", index))
    for index, phrase in enumerate(phrases):
        _check_phrase(phrase, slot_types, build_pointer("grammar", "phrases", index))
    total = sum(_longest(part) for phrase in phrases for part in phrase.parts)
    if total > MAX_GESTURES_IN_GRAMMAR:
        raise LanguageError(
            f"the phrases take {total} gestures in all, the limit is {MAX_GESTURES_IN_GRAMMAR}",
            "/grammar/phrases",
        )


def _check_names(names: Iterable[str], key: str) -> None:
    seen: set[str] = set()
    for index, name in enumerate(names):
        pointer = build_pointer("grammar", key, index, "name")
        if not name.strip() or len(name) > MAX_LABEL_LENGTH or not is_printable(name):
            raise LanguageError(
                f"must be 1 to {MAX_LABEL_LENGTH} printable characters, got {name!r}", pointer
            )
        if without_joiners(name) in seen:
            raise LanguageError(f"the name {name!r} occurs twice: rename one of the two", pointer)
        seen.add(without_joiners(name))


def _check_slot_type(slot_type: SlotType, pointer: str) -> None:
    if not slot_type.values:
        raise LanguageError("needs at least one gesture with a value", pointer + "/values")
    for index, value in enumerate(slot_type.values.values()):
        if not _fits(value, slot_type.reads_as):
            wanted = {"number": "a number", "text": "a text", "digits": "a digit, 0 to 9"}
            raise LanguageError(
                f"must be {wanted[slot_type.reads_as]}, got {value!r}",
                pointer + build_pointer("values", index, "value"),
            )


def _fits(value: Value | None, reads_as: str, *, together: bool = False) -> bool:
    """Return whether a value is one of the kind; `together`: as a whole, not digit by digit."""
    if reads_as == "text":
        return isinstance(value, str) and bool(value.strip()) and is_printable(value)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return False
    if reads_as == "number":
        return True
    return isinstance(value, int) and value >= 0 and (together or value <= 9)


def _check_phrase(phrase: Phrase, slot_types: Sequence[SlotType], pointer: str) -> None:
    if not phrase.parts or all(part.least == 0 for part in phrase.parts):
        raise LanguageError(
            f"{phrase.name!r} can be shown without any gesture: make one part required",
            pointer + "/parts",
        )
    for index, part in enumerate(phrase.parts):
        _check_part(part, slot_types, pointer + build_pointer("parts", index))
    if (longest := sum(_longest(part) for part in phrase.parts)) > MAX_GESTURES_IN_PHRASE:
        raise LanguageError(
            f"{phrase.name!r} may take {longest} gestures, the limit is {MAX_GESTURES_IN_PHRASE}",
            pointer + "/parts",
        )
    _check_slot_names(phrase, pointer)
    _check_words(phrase, pointer)


def _check_part(part: Part, slot_types: Sequence[SlotType], pointer: str) -> None:
    if not 0 <= part.least <= part.most or not 1 <= part.most <= MAX_REPEAT:
        raise LanguageError(
            f"least {part.least} and most {part.most}: must be 0 <= least <= most and 1 <= most <= "
            f"{MAX_REPEAT}",
            pointer + "/most",
        )
    if isinstance(part, OneOf):
        if not part.gestures or len(set(part.gestures)) < len(part.gestures):
            raise LanguageError("must name one gesture or more, each once", pointer + "/gestures")
    elif isinstance(part, Slot):
        _check_slot(part, slot_types, pointer)
    else:
        if not part.parts or all(each.least == 0 for each in part.parts):
            raise LanguageError("a group needs a part that is not optional", pointer + "/parts")
        for index, member in enumerate(part.parts):
            _check_part(member, slot_types, pointer + build_pointer("parts", index))


def _check_slot(slot: Slot, slot_types: Sequence[SlotType], pointer: str) -> None:
    if not SLOT_NAME.fullmatch(slot.name):
        raise LanguageError(
            f"{slot.name!r} is no name of a slot: a small letter, then at most 39 small letters, "
            "digits and underscores",
            pointer + "/slot",
        )
    known = {each.name: each for each in slot_types}
    if slot.slot_type not in known:
        raise LanguageError(
            f"no slot type {slot.slot_type!r}; there is {', '.join(known) or 'none'}",
            pointer + "/type",
        )
    reads_as = known[slot.slot_type].reads_as
    if slot.default is not None and not _fits(slot.default, reads_as, together=True):
        raise LanguageError(
            f"must be of the slot's type, which reads {reads_as}, got {slot.default!r}",
            pointer + "/default",
        )


def _check_slot_names(phrase: Phrase, pointer: str) -> None:
    seen: set[str] = set()
    for slot, group in phrase.slots():
        at = pointer + _place_of(phrase, slot, group)
        if slot.name in seen:
            raise LanguageError(
                f"a second slot {slot.name!r} in {phrase.name!r}: rename one", at + "/slot"
            )
        if group is not None and group.most > 1 and slot.most > 1:
            raise LanguageError(
                f"{slot.name!r} and its group may both be repeated, so its values cannot be "
                "assigned to repetitions: let only one of them repeat",
                at + "/most",
            )
        seen.add(slot.name)


def _place_of(phrase: Phrase, slot: Slot, group: Group | None) -> str:
    if group is None:
        return build_pointer("parts", phrase.parts.index(slot))
    return build_pointer("parts", phrase.parts.index(group), "parts", group.parts.index(slot))


def _check_words(phrase: Phrase, pointer: str) -> None:
    slots = {slot.name for slot, _ in phrase.slots()}
    missing = {
        slot.name
        for slot, group in phrase.slots()
        if slot.default is None and (slot.least == 0 or (group is not None and group.least == 0))
    }
    if len(phrase.says) > MAX_TEXT_LENGTH or not is_printable(phrase.says):
        raise LanguageError(
            f"must be at most {MAX_TEXT_LENGTH} printable characters", pointer + "/says"
        )
    if fault := find_template_fault(phrase.says, slots, missing):
        raise LanguageError(fault, pointer + "/says")
    with point_to(pointer + "/command"):
        check_command(phrase.command)
    for name in _names_in(phrase.command):
        if name not in slots:
            raise LanguageError(
                f"{{{name}}} is no slot of {phrase.name!r}; it has "
                f"{', '.join(sorted(slots)) or 'none'}",
                pointer + "/command",
            )


def _names_in(command: Any) -> set[str]:
    if isinstance(command, str):
        return set(find_placeholders(command))
    if isinstance(command, dict):
        command = list(command.values())
    if isinstance(command, list):
        return {name for each in command for name in _names_in(each)}
    return set()


def _longest(part: Part) -> int:
    once = sum(_longest(each) for each in part.parts) if isinstance(part, Group) else 1
    return part.most * once
