"""Validation of phrases: rules beyond the schema, with the JSON pointer of each error."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
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
)
from app.recognition.phrases.templates import find_placeholders, find_template_fault
from app.recognition.text.joiners import is_printable, without_joiners
from app.recognition.text.strict_json import build_pointer

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
