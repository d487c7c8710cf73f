"""Ambiguities: messages of a grammar with two meanings, each with the shortest example.

The search is exact: two walks over the automaton read the same gestures, and the difference of
their parses is tracked (as Weber and Klemm 1995 decide whether a transducer is a function). A
grammar without ambiguities here gives every message one meaning.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple, cast

from app.recognition.health.finding import Finding, FindingKind
from app.recognition.phrases.automaton import BEFORE, Parse, PhraseAutomaton
from app.recognition.phrases.grammar import Grammar
from app.recognition.text.wording import join_words

AmbiguityKind = Literal["same_sequence", "overlap", "run_together", "prefix", "unreachable"]

MESSAGES: Final[dict[AmbiguityKind, str]] = {
    "same_sequence": "the phrases {!r} and {!r} are both shown as {shown}, so neither is obeyed; "
    "let them differ in a gesture",
    "overlap": "the phrase {!r} reads {shown} in two ways: a gesture may fill a slot or be "
    "something else; give the slot other gestures, or put a gesture of its own between",
    "run_together": "{shown} can be split into phrases in two ways: choose a start and an end "
    "gesture that no phrase uses",
    "prefix": "after {shown} the message is complete, but may continue with {following}: the robot "
    "waits {timeout:g} s, and what it does depends on how fast the diver is; choose an end gesture "
    "that no phrase uses",
    "unreachable": "the phrase {!r} is never understood: each of its sequences has another "
    "meaning, too; give it a gesture of its own",
}
"""What is wrong and what to do, by the names of the phrases and the gestures shown."""


@dataclass(frozen=True)
class Ambiguity:
    """An ambiguity of a grammar.

    Attributes
    ----------
    kind
        ``same_sequence``: two phrases have the same gestures. ``overlap``: a gesture of one phrase
        may be a slot's value or something else. ``run_together``: the boundary between two phrases
        of a message is ambiguous. ``prefix``: a complete message could continue.
        ``unreachable``: every sequence of a phrase is ambiguous, so that it is never understood.
    phrases
        Names of the phrases concerned, each once.
    gestures
        An example message.
    message
        What is wrong and what to do, in a sentence.

    """

    kind: AmbiguityKind
    phrases: tuple[str, ...]
    gestures: tuple[str, ...]
    message: str

    def finding(self) -> Finding:
        """Return the ambiguity as a finding of the health report."""
        kind = cast("FindingKind", f"phrases_{self.kind}")
        return Finding(kind, (), self.message, error=True)


class _Lead(NamedTuple):
    """Contributions that only one of two walks has made so far; at least one of both is empty."""

    one: Parse
    other: Parse


_DIFFERENT = None
"""Value in place of a lead: the parses of the walks differ, whatever follows."""

_Pair = tuple[int, int, _Lead | None]
"""Two positions reached by the same gestures, and how their parses differ."""

_Walk = tuple[int, frozenset[tuple[int, _Lead | None]]]
"""A position, and every other parse of the gestures that led there."""


def find_ambiguities(grammar: Grammar) -> tuple[Ambiguity, ...]:
    """Find the ambiguities of a grammar, with one example for each pair of phrases."""
    single = PhraseAutomaton(grammar, most_phrases=1)
    search = _PairSearch(single)
    double = [_describe_ambiguity("same_sequence", single, *each) for each in search.two_parses()]
    found = [*double, *(_describe_ambiguity("prefix", single, *each) for each in search.prefixes())]
    if not found and _may_run_together(grammar):
        whole = PhraseAutomaton(grammar)
        search = _PairSearch(whole)
        found += [
            _describe_ambiguity("run_together", whole, *each) for each in search.two_parses()
        ][:1]
        found += [_describe_ambiguity("prefix", whole, *each) for each in search.prefixes()][:1]
    suspects = {name for each in double for name in each.phrases}
    for index, phrase in enumerate(grammar.phrases):
        if phrase.name in suspects and _is_unreachable(single, index):
            message = MESSAGES["unreachable"].format(phrase.name)
            example = grammar.example(phrase)
            found.append(Ambiguity("unreachable", (phrase.name,), example, message))
    return tuple(found)


def _may_run_together(grammar: Grammar) -> bool:
    """Return whether messages of several phrases can be ambiguous where single phrases are not.

    They cannot if the start gesture separates them and neither it nor the end gesture occurs in a
    phrase: then a message is split into phrases in one way only.
    """
    if grammar.most_phrases == 1:
        return False
    if grammar.start is None or grammar.start == grammar.end:
        return True
    inside = {use.label for use in grammar.uses() if use.role is None}
    return bool(inside & {grammar.start, grammar.end})


class _PairSearch:
    """Search of all pairs of positions that the same gestures lead to, the shortest first."""

    def __init__(self, automaton: PhraseAutomaton) -> None:
        self._automaton = automaton
        self._came_from: dict[_Pair, tuple[_Pair, str] | None] = {}
        self._visited: list[_Pair] = []
        self._explore()

    def two_parses(self) -> Iterator[tuple[tuple[str, ...], int, int]]:
        """Yield messages with two parses: the gestures, and the positions at which they end."""
        reported: set[frozenset[int | None]] = set()
        accepting, positions = self._automaton.accepting, self._automaton.positions
        for pair in self._visited:
            one, other, lead = pair
            if not {one, other} <= accepting or lead == _Lead((), ()):
                continue
            phrases = frozenset({positions[one].phrase, positions[other].phrase})
            if phrases not in reported:
                reported.add(phrases)
                yield self._gestures(pair), one, other

    def prefixes(self) -> Iterator[tuple[tuple[str, ...], int, int]]:
        """Yield messages that end at one position and continue at another."""
        reported: set[tuple[int | None, int | None]] = set()
        positions = self._automaton.positions
        for pair in self._visited:
            for over, goes_on in (pair[:2], pair[1::-1]):
                if over not in self._automaton.accepting or not self._automaton.following(goes_on):
                    continue
                phrases = (positions[over].phrase, positions[goes_on].phrase)
                if phrases not in reported:
                    reported.add(phrases)
                    yield self._gestures(pair), over, goes_on

    def _explore(self) -> None:
        start: _Pair = (BEFORE, BEFORE, _Lead((), ()))
        self._came_from[start] = None
        waiting = deque([start])
        while waiting:
            pair = waiting.popleft()
            self._visited.append(pair)
            for label, following in self._following(pair):
                if following not in self._came_from:
                    self._came_from[following] = (pair, label)
                    waiting.append(following)

    def _following(self, pair: _Pair) -> Iterator[tuple[str, _Pair]]:
        one, other, lead = pair
        theirs = self._automaton.moves[other]
        for label, mine in self._automaton.moves[one].items():
            for target, added in mine:
                for their_target, their_added in theirs.get(label, ()):
                    yield label, (target, their_target, _extend_lead(lead, added, their_added))

    def _gestures(self, pair: _Pair) -> tuple[str, ...]:
        gestures = []
        step = self._came_from[pair]
        while step is not None:
            pair, label = step
            gestures.append(label)
            step = self._came_from[pair]
        return tuple(reversed(gestures))


def _extend_lead(lead: _Lead | None, added: Parse, their_added: Parse) -> _Lead | None:
    """Return how two parses differ after one more gesture."""
    if lead is _DIFFERENT:
        return _DIFFERENT
    one, other = lead.one + added, lead.other + their_added
    common = min(len(one), len(other))
    if one[:common] != other[:common]:
        return _DIFFERENT
    return _Lead(one[common:], other[common:])


def _is_unreachable(automaton: PhraseAutomaton, phrase: int) -> bool:
    """Return whether every sequence of a phrase has a second parse.

    Searches the sequences of the phrase together with all their other parses.
    """
    begin: _Walk = (BEFORE, frozenset({(BEFORE, _Lead((), ()))}))
    waiting, known = deque([begin]), {begin}
    while waiting:
        position, others = waiting.popleft()
        if position in automaton.accepting and not any(
            other in automaton.accepting and lead != _Lead((), ()) for other, lead in others
        ):
            return False
        for label, moves in automaton.moves[position].items():
            for target, added in moves:
                if automaton.positions[target].phrase not in (None, phrase):
                    continue
                beside = frozenset(
                    (their_target, _extend_lead(lead, added, their_added))
                    for other, lead in others
                    for their_target, their_added in automaton.moves[other].get(label, ())
                )
                following: _Walk = (target, beside)
                if following not in known:
                    known.add(following)
                    waiting.append(following)
    return True


def _describe_ambiguity(
    kind: AmbiguityKind, automaton: PhraseAutomaton, gestures: tuple[str, ...], *ends: int
) -> Ambiguity:
    """Return the ambiguity of a message that two walks read, by the positions that they reach."""
    phrases = automaton.grammar.phrases
    indices = [automaton.positions[position].phrase for position in ends]
    names = tuple(dict.fromkeys(phrases[index].name for index in indices if index is not None))
    if kind == "same_sequence" and len(names) == 1:
        kind = "overlap"
    message = MESSAGES[kind].format(
        *names,
        shown=", ".join(gestures),
        following=join_words(sorted(automaton.moves[ends[-1]]), last="or"),
        timeout=automaton.grammar.timeout,
    )
    return Ambiguity(kind, names, gestures, message)
