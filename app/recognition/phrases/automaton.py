"""The finite automaton of a grammar's messages (Glushkov 1961).

Its positions are the occurrences of gestures in the grammar, every bounded repetition written out;
a message is a walk over positions, and what the walk says is its parse. Nothing is consumed
without a gesture, so the parser and the search for ambiguities both go gesture by gesture.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import NamedTuple

from app.recognition.phrases.grammar import Grammar
from app.recognition.phrases.phrase import Group, OneOf, Part, Value

BEFORE = -1
"""The position before the first gesture."""


class Contribution(NamedTuple):
    """What one gesture adds to a parse.

    A phrase that begins has only its index; a value has its slot, too.
    """

    phrase: int
    slot: str | None = None
    value: Value | None = None


Reading = tuple[Contribution, ...]
"""What a walk says, in order: for each phrase that it begins, and each value in a slot."""


@dataclass(frozen=True)
class Position:
    """One occurrence of a gesture in the grammar.

    Attributes
    ----------
    values
        Per label that may stand here its value; None for a gesture that carries none.
    phrase
        Index of the phrase that it is part of, or ends; None for a start gesture.
    turn
        Which of the message's phrases it is part of, from 0.
    slot
        Name of the slot that it fills, if it does.
    inside
        Whether it is part of the phrase, rather than of what frames it.

    """

    values: Mapping[str, Value | None]
    phrase: int | None
    turn: int
    slot: str | None = None
    inside: bool = True


@dataclass
class _Fragment:
    """Part of the automaton: where it begins and ends, and whether it may be left out."""

    first: tuple[int, ...] = ()
    last: tuple[int, ...] = ()
    nullable: bool = True


class PhraseAutomaton:
    """All messages of a grammar.

    Parameters
    ----------
    grammar
        Whose messages.
    most_phrases
        Phrases in one message; as the grammar says when None.

    Attributes
    ----------
    positions
        Every occurrence of a gesture.
    accepting
        Positions at which a message may be over.

    """

    def __init__(self, grammar: Grammar, most_phrases: int | None = None) -> None:
        self.grammar = grammar
        self.positions: list[Position] = []
        self._follow: list[set[int]] = []
        self._first: set[int] = set()
        accepting: set[int] = set()
        before: set[int] | None = None  # None: the beginning
        for turn in range(most_phrases or grammar.most_phrases):
            before, over = self._add_turn(turn, before)
            accepting |= over
        self.accepting = frozenset(accepting)

    def following(self, position: int) -> frozenset[int]:
        """Return the positions that may come next."""
        return frozenset(self._first if position == BEFORE else self._follow[position])

    def moves(self, position: int) -> Mapping[str, Sequence[tuple[int, Reading]]]:
        """Return per label the positions that it leads to, and what that adds to the parse."""
        return self._moves[position]

    @cached_property
    def _moves(self) -> dict[int, dict[str, list[tuple[int, Reading]]]]:
        table: dict[int, dict[str, list[tuple[int, Reading]]]] = {}
        for position in range(BEFORE, len(self.positions)):
            moves = table.setdefault(position, {})
            for target in sorted(self.following(position)):
                for label in self.positions[target].values:
                    moves.setdefault(label, []).append(
                        (target, self._said(position, target, label))
                    )
        return table

    def _said(self, position: int, target: int, label: str) -> Reading:
        there = self.positions[target]
        if not there.inside or there.phrase is None:
            return ()
        here = None if position == BEFORE else self.positions[position]
        begins = here is None or not here.inside or here.turn != there.turn
        said: Reading = (Contribution(there.phrase),) if begins else ()
        if there.slot is not None:
            said += (Contribution(there.phrase, there.slot, there.values[label]),)
        return said

    def _add_turn(self, turn: int, before: set[int] | None) -> tuple[set[int], set[int]]:
        """Add one more phrase of a message.

        Returns
        -------
        The positions after which another phrase may begin, and those at which the message may be
        over.

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
            self._join(set(fragment.last), (end,))
            over.add(end)
        return done, over

    def _join(self, before: set[int] | None, targets: Sequence[int]) -> None:
        if before is None:
            self._first.update(targets)
            return
        for position in before:
            self._follow[position].update(targets)

    def _add(self, position: Position) -> int:
        self.positions.append(position)
        self._follow.append(set())
        return len(self.positions) - 1

    def _sequence(self, parts: Sequence[Part], phrase: int, turn: int) -> _Fragment:
        whole = _Fragment()
        for part in parts:
            whole = self._concatenated(whole, self._repeated(part, phrase, turn))
        return whole

    def _repeated(self, part: Part, phrase: int, turn: int) -> _Fragment:
        """Write a part out `most` times; from `least` on, all that is left may be left out."""
        tail = _Fragment()
        for index in reversed(range(part.most)):
            tail = self._concatenated(self._once(part, phrase, turn), tail)
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

    def _concatenated(self, one: _Fragment, other: _Fragment) -> _Fragment:
        self._join(set(one.last), other.first)
        return _Fragment(
            first=tuple(chain(one.first, other.first if one.nullable else ())),
            last=tuple(chain(other.last, one.last if other.nullable else ())),
            nullable=one.nullable and other.nullable,
        )
