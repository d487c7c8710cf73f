"""Grammars for tests: one like CADDIAN's missions, and arbitrary ones with all they can say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from math import isqrt, prod

from hypothesis import strategies as st

from app.recognition.phrases.automaton import Contribution, Parse
from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import Group, OneOf, Part, Phrase, Slot, SlotType

LABELS = ("a", "b", "c")

MOST_MESSAGES = 500
"""Most messages of a random grammar: all of them are written out for comparison."""

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
def members(draw: st.DrawFn, name: str, *, least: int, most: int) -> OneOf | Slot:
    if draw(st.booleans()):
        return Slot(name, draw(st.sampled_from(["first", "second"])), least, most)
    gestures = draw(st.lists(st.sampled_from(LABELS), min_size=1, max_size=2, unique=True))
    return OneOf(tuple(gestures), least, most)


@st.composite
def parts(draw: st.DrawFn, name: str, *, least: int) -> Part:
    most = draw(st.integers(1, 2))
    if draw(st.integers(0, 3)) > 0:
        return draw(members(name, least=least, most=most))
    count = draw(st.integers(1, 2))
    needed = draw(st.integers(0, count - 1))
    inside = [
        draw(
            members(
                f"{name}_{index}",
                least=1 if index == needed else draw(st.integers(0, 1)),
                # Only one of a slot and its group may be repeated.
                most=1 if most > 1 else draw(st.integers(1, 2)),
            )
        )
        for index in range(count)
    ]
    return Group(tuple(inside), least, most)


@st.composite
def phrases(draw: st.DrawFn, name: str, most_ways: int) -> Phrase:
    """Draw a phrase that can be shown in one way at least and in `most_ways` at most."""
    count = draw(st.integers(1, 3))
    needed = draw(st.integers(0, count - 1))
    drawn: list[Part] = []
    for index in range(count):
        least = 1 if index == needed else draw(st.integers(0, 1))
        part = _limit(draw(parts(f"slot{index}", least=least)), most_ways)
        most_ways //= _ways(part)
        drawn.append(part)
    return Phrase(name, tuple(drawn))


def _limit(part: Part, most_ways: int) -> Part:
    """Reduce a part until it can be shown in a given number of ways at most."""
    smaller: list[Part] = [part, replace(part, most=1), replace(part, least=1, most=1)]
    if isinstance(part, Group):
        smaller += [replace(member, least=1, most=1) for member in part.parts]
    fitting = (each for each in smaller if _ways(each) <= most_ways)
    return next(fitting, one(LABELS[0]))


@st.composite
def grammars(draw: st.DrawFn) -> Grammar:
    """Draw a small grammar over three gestures, with or without start and end."""
    frame = st.sampled_from([None, "a", "start"])
    start, end = draw(frame), draw(st.sampled_from([None, "c", "end"]))
    most = draw(st.integers(1, 2)) if end is not None else 1
    count = draw(st.integers(1, 3))
    single = MOST_MESSAGES if most == 1 else isqrt(MOST_MESSAGES) - 1
    drawn = [draw(phrases(f"phrase {number}", single // count)) for number in range(count)]
    return Grammar(tuple(drawn), _TYPES, start, end, most_phrases=most)


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
    """Return every message of a grammar and its reading, by writing all repetitions out.

    Independent of automata: the results of the check and the parser are compared with it.
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
