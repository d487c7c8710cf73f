"""Grammar entry: conversion of grammars to and from their entry in the language file."""

from __future__ import annotations

from app.recognition.errors import LanguageError
from app.recognition.language.grammar_schema import (
    GesturesEntry,
    GrammarEntry,
    GroupEntry,
    PartEntry,
    PhraseEntry,
    SlotEntry,
    SlotTypeEntry,
    SlotValueEntry,
)
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import Group, OneOf, Part, Phrase, Slot, SlotType, Value
from app.recognition.text.strict_json import build_pointer


def grammar_to_entry(grammar: Grammar) -> GrammarEntry:
    """Return the file's entry of a grammar."""
    return GrammarEntry(
        start=grammar.start,
        end=grammar.end,
        cancel=grammar.cancel,
        timeout=grammar.timeout,
        most_phrases=grammar.most_phrases,
        slot_types=[_slot_type_entry(each) for each in grammar.slot_types],
        phrases=[
            PhraseEntry(
                name=phrase.name,
                parts=[_part_entry(part) for part in phrase.parts],
                command=phrase.command,
                says=phrase.says,
            )
            for phrase in grammar.phrases
        ],
    )


def entry_to_grammar(entry: GrammarEntry) -> Grammar:
    """Return the grammar of a file's entry.

    Raises
    ------
    LanguageError
        When it is inconsistent; its pointer is that of the language file.

    """
    return Grammar(
        phrases=tuple(
            Phrase(each.name, tuple(map(_part, each.parts)), each.command, each.says)
            for each in entry.phrases
        ),
        slot_types=tuple(
            _slot_type(each, build_pointer("grammar", "slot_types", index))
            for index, each in enumerate(entry.slot_types)
        ),
        start=entry.start,
        end=entry.end,
        cancel=entry.cancel,
        timeout=entry.timeout,
        most_phrases=entry.most_phrases,
    )


def _part_entry(part: Part) -> PartEntry:
    if isinstance(part, Group):
        members = [_member_entry(member) for member in part.parts]
        return GroupEntry(parts=members, least=part.least, most=part.most)
    return _member_entry(part)


def _member_entry(part: OneOf | Slot) -> GesturesEntry | SlotEntry:
    if isinstance(part, OneOf):
        return GesturesEntry(gestures=list(part.gestures), least=part.least, most=part.most)
    return SlotEntry(
        slot=part.name,
        type=part.slot_type,
        least=part.least,
        most=part.most,
        default=part.default,
    )


def _part(entry: PartEntry) -> Part:
    if isinstance(entry, GroupEntry):
        return Group(tuple(map(_member, entry.parts)), entry.least, entry.most)
    return _member(entry)


def _member(entry: GesturesEntry | SlotEntry) -> OneOf | Slot:
    if isinstance(entry, GesturesEntry):
        return OneOf(tuple(entry.gestures), entry.least, entry.most)
    return Slot(entry.slot, entry.type, entry.least, entry.most, entry.default)


def _slot_type_entry(slot_type: SlotType) -> SlotTypeEntry:
    values = [SlotValueEntry(gesture=name, value=v) for name, v in slot_type.values.items()]
    return SlotTypeEntry(name=slot_type.name, reads_as=slot_type.reads_as, values=values)


def _slot_type(entry: SlotTypeEntry, pointer: str) -> SlotType:
    values: dict[str, Value] = {}
    for index, each in enumerate(entry.values):
        if each.gesture in values:
            raise LanguageError(
                f"a second value of {each.gesture!r} in {entry.name!r}: remove one of the two",
                pointer + build_pointer("values", index, "gesture"),
            )
        values[each.gesture] = each.value
    return SlotType(entry.name, entry.reads_as, values)
