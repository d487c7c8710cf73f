"""Phrase automaton: the finite automaton of a grammar's messages (Glushkov 1961).

Its positions are the occurrences of gestures in the grammar, with every bounded repetition written
out; a message is a walk over positions that yields its parse. Every step consumes a gesture, so the
parser and the search for ambiguities work gesture by gesture.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import Group, OneOf, Part, Value

BEFORE = -1
"""The position before the first gesture."""


class Contribution(NamedTuple):
    """One element of a parse: the beginning of a phrase, or a value in a slot."""

    phrase: int
    slot: str | None = None
    value: Value | None = None


Parse = tuple[Contribution, ...]
"""The contributions of a walk in order: each phrase that begins, and each value in a slot."""


@dataclass(frozen=True)
class Position:
    """One occurrence of a gesture in the grammar.

    Attributes
    ----------
    values
        By allowed label its value; None for a gesture without value.
    phrase
        Index of the phrase that it is part of, or ends; None for a start gesture.
    turn
        Index of its phrase in the message, from 0.
    slot
        Name of the slot that it fills, if any.
    inside
        Whether it is part of the phrase, not of the frame.

    """

    values: Mapping[str, Value | None]
    phrase: int | None
    turn: int
    slot: str | None = None
    inside: bool = True


@dataclass
class _Fragment:
    """Part of the automaton: its first and last positions, and whether it is optional."""

    first: tuple[int, ...] = ()
    last: tuple[int, ...] = ()
    nullable: bool = True


class PhraseAutomaton:
    """The finite automaton of all messages of a grammar.

    Parameters
    ----------
    grammar
        The grammar.
    most_phrases
        Phrases in one message; the grammar's own number when None.

    Attributes
    ----------
    positions
        Every occurrence of a gesture.
    accepting
        Positions at which a message may end.

    """

    def __init__(self, grammar: Grammar, most_phrases: int | None = None) -> None:
        self.grammar = grammar
        self.positions: list[Position] = []
        self._follow: dict[int, set[int]] = {BEFORE: set()}
        accepting: set[int] = set()
        before = {BEFORE}
        for turn in range(most_phrases or grammar.most_phrases):
            before, over = self._add_turn(turn, before)
            accepting |= over
        self.accepting = frozenset(accepting)

    def following(self, position: int) -> frozenset[int]:
        """Return the positions that may follow."""
        return frozenset(self._follow[position])

    @cached_property
    def moves(self) -> Mapping[int, Mapping[str, Sequence[tuple[int, Parse]]]]:
        """By position and label the positions that follow, each with its addition to the parse."""
        table: dict[int, dict[str, list[tuple[int, Parse]]]] = {}
        for position in range(BEFORE, len(self.positions)):
            moves = table.setdefault(position, {})
            for target in sorted(self.following(position)):
                for label in self.positions[target].values:
                    moves.setdefault(label, []).append(
                        (target, self._contributions(position, target, label))
                    )
        return table

    def _contributions(self, position: int, target: int, label: str) -> Parse:
        there = self.positions[target]
        if not there.inside or there.phrase is None:
            return ()
        here = None if position == BEFORE else self.positions[position]
        begins = here is None or not here.inside or here.turn != there.turn
        added: Parse = (Contribution(there.phrase),) if begins else ()
        if there.slot is not None:
            added += (Contribution(there.phrase, there.slot, there.values[label]),)
        return added

    def _add_turn(self, turn: int, before: set[int]) -> tuple[set[int], set[int]]:
        """Add one more phrase to a message.

        Returns
        -------
        The positions after which another phrase may begin, and those at which the message may end.

        """
        grammar = self.grammar
        if grammar.start is not None:
            start = self._add(Position({grammar.start: None}, None, turn, inside=False))
            self._join(before, (start,))
            before = {start}
        done: set[int] = set()
        over: set[int] = set()
        for index, phrase in enumerate(grammar.phrases):
            fragment = self._sequence(phrase.parts, index, turn)
            self._join(before, fragment.first)
            done.update(fragment.last)
            if grammar.end is None:
                over.update(fragment.last)
                continue
            end = self._add(Position({grammar.end: None}, index, turn, inside=False))
            self._join(fragment.last, (end,))
            over.add(end)
        return done, over

    def _join(self, before: Iterable[int], targets: Sequence[int]) -> None:
        for position in before:
            self._follow[position].update(targets)

    def _add(self, position: Position) -> int:
        added = len(self.positions)
        self.positions.append(position)
        self._follow[added] = set()
        return added

    def _sequence(self, parts: Sequence[Part], phrase: int, turn: int) -> _Fragment:
        whole = _Fragment()
        for part in parts:
            whole = self._concatenate(whole, self._repeat(part, phrase, turn))
        return whole

    def _repeat(self, part: Part, phrase: int, turn: int) -> _Fragment:
        """Repeat a part `most` times; repetitions beyond `least` are optional."""
        tail = _Fragment()
        for index in reversed(range(part.most)):
            tail = self._concatenate(self._once(part, phrase, turn), tail)
            tail.nullable = tail.nullable or index >= part.least
        return tail

    def _once(self, part: Part, phrase: int, turn: int) -> _Fragment:
        if isinstance(part, Group):
            return self._sequence(part.parts, phrase, turn)
        if isinstance(part, OneOf):
            position = Position(dict.fromkeys(part.gestures), phrase, turn)
        else:
            values = self.grammar.slot_type(part.slot_type).values
            position = Position(values, phrase, turn, slot=part.name)
        added = self._add(position)
        return _Fragment((added,), (added,), nullable=False)

    def _concatenate(self, one: _Fragment, other: _Fragment) -> _Fragment:
        self._join(one.last, other.first)
        return _Fragment(
            first=(*one.first, *(other.first if one.nullable else ())),
            last=(*other.last, *(one.last if other.nullable else ())),
            nullable=one.nullable and other.nullable,
        )
