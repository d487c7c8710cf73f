"""Grammars for tests: one like CADDIAN's missions, and arbitrary ones with all they can say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from math import prod

from hypothesis import assume
from hypothesis import strategies as st

from app.recognition import LanguageError
from app.recognition.phrases.automaton import Contribution, Parse
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import Group, OneOf, Part, Phrase, Slot, SlotType

LABELS = ("a", "b", "c")

MOST_MESSAGES = 500
"""Of a grammar that is drawn: all of them are written out to compare with."""

NUMBER = SlotType("number", "number", {"two": 2, "three": 3})
DIRECTION = SlotType("direction", "text", {"left": "left", "right": "right"})
DEPTH = SlotType("depth", "digits", {"one": 1, "two": 2, "three": 3})


def one(*gestures: str, least: int = 1, most: int = 1) -> OneOf:
    return OneOf(gestures, least, most)


PHOTO = Phrase(
    "photo",
    (
        one("photo", "picture"),
        Slot("times", "number", least=0, default=1),
        Group((one("down"), Slot("depth", "depth", most=2)), least=0),
    ),
    {"do": "photo", "times": "{times}", "at": {"depth": "{depth}"}},
    "photo[, {times} times][, at {depth} metres]",
)
GO = Phrase("go", (one("go"), Slot("way", "direction")), "go {way}", "go {way}")

MISSIONS = Grammar(
    phrases=(PHOTO, GO),
    slot_types=(NUMBER, DIRECTION, DEPTH),
    start="start",
    end="end",
    cancel="cancel",
    most_phrases=3,
)

_TYPES = (SlotType("first", "number", {"a": 1, "b": 2}), SlotType("second", "text", {"b": "B"}))


@st.composite
def members(draw: st.DrawFn, name: str) -> OneOf | Slot:
    least = draw(st.integers(0, 1))
    most = draw(st.integers(1, 2))
    if draw(st.booleans()):
        return Slot(name, draw(st.sampled_from(["first", "second"])), least, most)
    gestures = draw(st.lists(st.sampled_from(LABELS), min_size=1, max_size=2, unique=True))
    return OneOf(tuple(gestures), least, most)


@st.composite
def parts(draw: st.DrawFn, name: str) -> Part:
    if draw(st.integers(0, 3)) > 0:
        return draw(members(name))
    inside = [draw(members(f"{name}_{index}")) for index in range(draw(st.integers(1, 2)))]
    return Group(tuple(inside), draw(st.integers(0, 1)), draw(st.integers(1, 2)))


@st.composite
def grammars(draw: st.DrawFn) -> Grammar:
    """Draw a small grammar over three gestures, with or without start and end."""
    phrases = [
        Phrase(
            f"phrase {number}",
            tuple(draw(parts(f"slot{index}")) for index in range(draw(st.integers(1, 3)))),
        )
        for number in range(draw(st.integers(1, 3)))
    ]
    frame = st.sampled_from([None, "a", "start"])
    start, end = draw(frame), draw(st.sampled_from([None, "c", "end"]))
    most = draw(st.integers(1, 2)) if end is not None else 1
    single = sum(prod(map(_ways, phrase.parts)) for phrase in phrases)
    assume(sum(single**count for count in range(1, most + 1)) <= MOST_MESSAGES)
    try:
        return Grammar(tuple(phrases), _TYPES, start, end, most_phrases=most)
    except LanguageError:
        assume(False)  # a phrase without a needed part, for instance
        raise


def _ways(part: Part) -> int:
    """Count the ways to show a part."""
    if isinstance(part, Group):
        once = prod(map(_ways, part.parts))
    elif isinstance(part, Slot):
        once = next(len(each.values) for each in _TYPES if each.name == part.slot_type)
    else:
        once = len(part.gestures)
    return sum(once**count for count in range(part.least, part.most + 1))


Sentence = tuple[tuple[str, ...], Parse]


def sentences(grammar: Grammar) -> Iterator[Sentence]:
    """Give every message of a grammar and its reading, by writing all repetitions out.

    Knows nothing of automata: what the check and the parser say is compared with it.
    """
    types = {each.name: each for each in grammar.slot_types}
    opening = () if grammar.start is None else (grammar.start,)
    closing = () if grammar.end is None else (grammar.end,)
    single = [
        (opening + labels, (Contribution(index), *said))
        for index, phrase in enumerate(grammar.phrases)
        for labels, said in _sequences(phrase.parts, index, types)
    ]
    for count in range(1, grammar.most_phrases + 1):
        for chosen in product(single, repeat=count):
            yield (
                tuple(label for labels, _ in chosen for label in labels) + closing,
                tuple(each for _, said in chosen for each in said),
            )


def _sequences(
    parts: Sequence[Part], phrase: int, types: Mapping[str, SlotType]
) -> Iterator[Sentence]:
    choices = [list(_repetitions(part, phrase, types)) for part in parts]
    for chosen in product(*choices):
        yield (
            tuple(label for labels, _ in chosen for label in labels),
            tuple(each for _, said in chosen for each in said),
        )


def _repetitions(part: Part, phrase: int, types: Mapping[str, SlotType]) -> Iterator[Sentence]:
    once: list[Sentence]
    if isinstance(part, Group):
        once = list(_sequences(part.parts, phrase, types))
    elif isinstance(part, Slot):
        values = types[part.slot_type].values.items()
        once = [((label,), (Contribution(phrase, part.name, value),)) for label, value in values]
    else:
        once = [((label,), ()) for label in part.gestures]
    for count in range(part.least, part.most + 1):
        yield from _sequences_of(once, count)


def _sequences_of(once: list[Sentence], count: int) -> Iterator[Sentence]:
    for chosen in product(once, repeat=count):
        yield (
            tuple(label for labels, _ in chosen for label in labels),
            tuple(each for _, said in chosen for each in said),
        )
