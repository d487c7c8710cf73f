"""Grammar entry of a language file, and its schema."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any

from pydantic import BaseModel, Discriminator, Field, Tag

from app.recognition.errors import LanguageError
from app.recognition.gestures.gesture import MAX_LABEL_LENGTH, MAX_TEXT_LENGTH
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import (
    MAX_REPEAT,
    Group,
    OneOf,
    Part,
    Phrase,
    ReadsAs,
    Slot,
    SlotType,
    Value,
)
from app.recognition.text.described import STRICT
from app.recognition.text.strict_json import build_pointer

MAX_ENTRIES = 100
"""Longest list; longer ones are refused before their entries are validated."""

Name = Annotated[str, Field(min_length=1, max_length=MAX_LABEL_LENGTH)]
Text = Annotated[str, Field(max_length=MAX_TEXT_LENGTH)]
FiniteFloat = Annotated[float, Field(allow_inf_nan=False)]
SlotValue = Annotated[
    Name | int | FiniteFloat, Field(description="Text or a number, as the slot type says.")
]
Times = Annotated[int, Field(ge=0, le=MAX_REPEAT)]


class _Model(BaseModel):
    model_config = STRICT


Least = Annotated[
    Times, Field(description="How often at least; 0: may be left out. Left out when 1.")
]
Most = Annotated[Times, Field(ge=1, description="How often at most. Left out when 1.")]


class GesturesEntry(_Model):
    """One gesture out of some, which carries no value."""

    gestures: Annotated[list[Name], Field(min_length=1, max_length=MAX_ENTRIES)]
    """Labels, any of which will do."""
    least: Least = 1
    most: Most = 1


class SlotEntry(_Model):
    """A gesture that carries a value for the command."""

    slot: Annotated[str, Field(pattern="^[a-z][a-z0-9_]{0,39}$")]
    """Name by which command and spoken text refer to the value."""
    type: Name
    """Name of the slot type that may stand here."""
    least: Least = 1
    most: Most = 1
    default: SlotValue | None = None
    """The command's value where the slot was left out. Left out when none."""


def _kind_of_member(entry: Any) -> str | None:
    """Return the kind of a part by the key that only this kind has."""
    for key in ("gestures", "slot"):
        if (key in entry) if isinstance(entry, dict) else hasattr(entry, key):
            return f"{key}-part"
    return None


def _kind_of_part(entry: Any) -> str | None:
    if ("parts" in entry) if isinstance(entry, dict) else hasattr(entry, "parts"):
        return "group-part"
    return _kind_of_member(entry)


_WANTED = {
    "custom_error_type": "part_kind",
    "custom_error_message": 'a part has the key "gestures", "slot" or "parts"; a group no groups',
}

MemberEntry = Annotated[
    Annotated[GesturesEntry, Tag("gestures-part")] | Annotated[SlotEntry, Tag("slot-part")],
    Discriminator(_kind_of_member, **_WANTED),
]


class GroupEntry(_Model):
    """Parts that are left out or repeated together."""

    parts: Annotated[list[MemberEntry], Field(min_length=1, max_length=MAX_ENTRIES)]
    least: Least = 1
    most: Most = 1


PartEntry = Annotated[
    Annotated[GesturesEntry, Tag("gestures-part")]
    | Annotated[SlotEntry, Tag("slot-part")]
    | Annotated[GroupEntry, Tag("group-part")],
    Discriminator(_kind_of_part, **_WANTED),
]


class SlotValueEntry(_Model):
    """What a gesture stands for in a slot."""

    gesture: Name
    value: SlotValue


class SlotTypeEntry(_Model):
    """The gestures that may fill a slot."""

    name: Name
    reads_as: ReadsAs
    """A number or a text each, or digits that make one number together."""
    values: Annotated[list[SlotValueEntry], Field(min_length=1, max_length=MAX_ENTRIES)]


class PhraseEntry(_Model):
    """Sequences of gestures with one meaning."""

    name: Name
    parts: Annotated[list[PartEntry], Field(min_length=1, max_length=MAX_ENTRIES)]
    command: Text | dict[str, Any] | None = None
    """What the robot should do: text or an object, in which {slot} stands for a value, or null.
    Left out when null."""
    says: Text = ""
    """How it is spoken back: {slot} stands for a value, what is in [ ] is left out with its slots.
    Left out: the name and the values."""


Label = Annotated[Name | None, Field(description="A gesture's label. Left out when none.")]


class GrammarEntry(_Model):
    """Which sequences of gestures are phrases, and what each tells the robot."""

    start: Label = None
    end: Label = None
    cancel: Label = None
    timeout: Annotated[FiniteFloat, Field(gt=0)]
    """Most seconds between the end of a gesture and the start of the next."""
    most_phrases: Annotated[int, Field(ge=1)] = 1
    """Phrases in one message. Left out when 1."""
    slot_types: Annotated[list[SlotTypeEntry], Field(max_length=MAX_ENTRIES)] = []
    phrases: Annotated[list[PhraseEntry], Field(max_length=MAX_ENTRIES)]


def grammar_to_entry(grammar: Grammar) -> GrammarEntry:
    """Return the file's entry of a grammar."""
    return GrammarEntry.model_validate(asdict(grammar, dict_factory=_name_keys), strict=False)


def _name_keys(fields: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return the fields of a part of a grammar by the file's keys, where these differ."""
    entry = dict(fields)
    if "slot_type" in entry:
        entry |= {"slot": entry.pop("name"), "type": entry.pop("slot_type")}
    if "values" in entry:
        entry["values"] = [{"gesture": label, "value": v} for label, v in entry["values"].items()]
    return entry


def entry_to_grammar(entry: GrammarEntry) -> Grammar:
    """Return the grammar of a file's entry.

    Raises
    ------
    LanguageError
        When it is inconsistent; its pointer is that of the language file.

    """
    read: dict[str, Any] = dict(vars(entry))
    read["phrases"] = tuple(
        Phrase(each.name, tuple(map(_part, each.parts)), each.command, each.says)
        for each in entry.phrases
    )
    read["slot_types"] = tuple(
        _slot_type(each, build_pointer("grammar", "slot_types", index))
        for index, each in enumerate(entry.slot_types)
    )
    return Grammar(**read)


def _part(entry: PartEntry) -> Part:
    if isinstance(entry, GroupEntry):
        return Group(tuple(map(_member, entry.parts)), entry.least, entry.most)
    return _member(entry)


def _member(entry: GesturesEntry | SlotEntry) -> OneOf | Slot:
    if isinstance(entry, GesturesEntry):
        return OneOf(tuple(entry.gestures), entry.least, entry.most)
    return Slot(entry.slot, entry.type, entry.least, entry.most, entry.default)


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
