"""Choice: which gestures of a language, or of candidates, are told apart best.

Each demonstration is compared with every other gesture, as other people show it where several have
shown the language. The nearer two gestures are, the more they are mixed up, and the sum over all
pairs is the cost of a language. Nothing is simulated. How far a gesture's own demonstrations are
apart does not count: the limit of a language follows from that (`docs/results.md`, *Choosing*).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np

from app.recognition.explanation.causes import ALIKE
from app.recognition.explanation.context import KnownTake
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.gesture import Gesture
from app.recognition.health.forecast import compare_people
from app.recognition.language.language import Language
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer
from app.recognition.text.look_alikes import find_confusable

SPREAD: Final = 0.2
"""Mean novelty of two gestures for each other at which they cost a third of what the same gesture
would (`docs/results.md`, *Choosing*)."""

FAR: Final = 3.0
"""Largest novelty; what cannot be compared counts as much."""

MOST_TRIED: Final = 20_000
"""Most choices of which every one is tried; of more, one gesture after the other is exchanged."""

MOST_PROPOSED: Final = 6
"""Most replacements of a gesture that are proposed."""


@dataclass(frozen=True)
class ConfusedPair:
    """Two gestures that are mixed up.

    Attributes
    ----------
    gestures
        Their labels.
    rate
        How sure their takes are to be read as the other one, in [0, 1]; for their order.
    distance
        Least novelty of a demonstration of one for the other.
    mixed, compared
        How many takes and demonstrations of both were nearer to the other one, and of how many.

    """

    gestures: tuple[str, str]
    rate: float
    distance: float
    mixed: int
    compared: int

    @property
    def is_alike(self) -> bool:
        """Whether one's demonstration is as near to the other as a take of it."""
        return self.distance < ALIKE

    @property
    def words(self) -> str:
        """What is known of the pair, in words."""
        apart = "rather alike" if self.mixed else "told apart"
        alike = "nearly alike" if self.is_alike else apart
        if not self.compared:
            return f"{alike}, distance {self.distance:.2f}"
        return f"{alike}, {self.mixed} of {self.compared} takes are nearer to the other one"


@dataclass(frozen=True, eq=False)
class Confusions:
    """How often the gestures of a language are mixed up.

    Attributes
    ----------
    labels
        Of G gestures.
    rates
        ``(G, G)`` in [0, 1], symmetric: how much two gestures are mixed up; 0 on the diagonal.
    nearest
        ``(G, G)``: least novelty of a demonstration of the row's gesture for the column's.
    mixed, compared
        ``(G, G)`` and ``(G,)``: how many takes and demonstrations of the row's gesture were nearer
        to the column's than to those of other people, and of how many.
    people
        Number of people who have shown them; by one person's only distances are known.

    """

    labels: tuple[str, ...]
    rates: FloatArray
    nearest: FloatArray
    mixed: FloatArray
    compared: FloatArray
    people: int

    def measure_misread(self, chosen: Sequence[int]) -> float:
        """Return the mean over gestures of the estimated share of takes that is not read right."""
        rows = np.array(chosen, dtype=np.intp)
        return float(1 - np.prod(1 - self.rates[np.ix_(rows, rows)], axis=1).mean())

    def list_pairs(self, among: Sequence[int] | None = None) -> list[ConfusedPair]:
        """Return the pairs of gestures, those that are mixed up most first."""
        rows = range(len(self.labels)) if among is None else among
        found = [self.compare(one, other) for one, other in combinations(rows, 2)]
        return sorted(found, key=lambda each: -each.rate)

    def compare(self, one: int, other: int) -> ConfusedPair:
        """Return what is known of two gestures."""
        return ConfusedPair(
            gestures=(self.labels[one], self.labels[other]),
            rate=float(self.rates[one, other]),
            distance=float(min(self.nearest[one, other], self.nearest[other, one])),
            mixed=int(self.mixed[one, other] + self.mixed[other, one]),
            compared=int(self.compared[one] + self.compared[other]),
        )

    def choose(self, count: int, fixed: Sequence[int] = ()) -> list[int]:
        """Return the `count` gestures of least cost beside the `fixed` ones, in their order.

        All choices are tried where they are few; else gestures are added one by one and exchanged
        as long as that helps.
        """
        free = [index for index in range(len(self.labels)) if index not in {*fixed}]
        costs = self.rates[np.ix_(free, free)]
        costs += np.diag(2 * self.rates[np.ix_(free, list(fixed))].sum(axis=1))
        return [free[at] for at in _choose_cheapest(costs, min(count, len(free)))]


def _choose_cheapest(costs: FloatArray, count: int) -> list[int]:
    """Return the `count` rows whose square of symmetric ``(G, G)`` costs has the least sum."""
    size = len(costs)
    if math.comb(size, count) <= MOST_TRIED:
        rows = np.array(list(combinations(range(size), count)), dtype=np.intp)
        sums = costs[rows[:, :, None], rows[:, None, :]].sum(axis=(1, 2))
        return [int(each) for each in rows[int(sums.argmin())]]

    def add(chosen: Sequence[int]) -> list[int]:
        added = 2 * costs[:, chosen].sum(axis=1) + np.diag(costs)
        added[list(chosen)] = np.inf
        return [*chosen, int(added.argmin())]

    def measure(chosen: Sequence[int]) -> float:
        return float(costs[np.ix_(chosen, chosen)].sum())

    chosen: list[int] = []
    for _ in range(count):
        chosen = add(chosen)
    for _ in range(size):
        best = min((add(chosen[:at] + chosen[at + 1 :]) for at in range(count)), key=measure)
        if measure(best) >= measure(chosen) - 1e-12:
            break
        chosen = best
    return sorted(chosen)


def describe_people(people: int) -> str:
    """Return by whose demonstrations confusions are known, in one sentence."""
    if people < 2:
        return "By the distances of one person's demonstrations: other people may differ."
    return f"By the demonstrations of {people} people, each read by the others'."


@dataclass(frozen=True)
class Replacement:
    """Another movement for a gesture, and what it would do to the language.

    Attributes
    ----------
    candidate
        Index among the candidates.
    before, after
        Estimated share of takes of all gestures that is not read right: now, and with it.
    nearest
        The gesture with this movement, and the other one that would be nearest to it; None in a
        language of one gesture.
    alike
        Pairs of gestures that would be nearly alike, those that are mixed up most first.
    people
        By how many people's demonstrations of the language this is known.

    """

    candidate: int
    before: float
    after: float
    nearest: ConfusedPair | None
    alike: tuple[ConfusedPair, ...]
    people: int


def join_candidates(language: Language, candidates: Sequence[Gesture]) -> Language:
    """Return a language without phrases, with candidates under labels of no meaning at its end."""
    named = []
    for index, each in enumerate(candidates):
        label = f"candidate {index}"
        while find_confusable(label, language.labels) is not None:
            label += "'"
        named.append(replace(each, label=label))
    return replace(language, gestures=[*language.gestures, *named], grammar=None)


def find_replacements(
    language: Language,
    label: str,
    candidates: Sequence[Gesture],
    known: Sequence[KnownTake] = (),
    *,
    advance: Callable[[], None] = lambda: None,
) -> tuple[Replacement, ...]:
    """Find the candidates that fit best in the place of a gesture.

    Parameters
    ----------
    language, known, advance
        As for `measure_confusions`.
    label
        Of the gesture.
    candidates
        Gestures with a demonstration; their labels do not matter.

    Returns
    -------
    Those with which fewer takes are not read right than now, the best first, `MOST_PROPOSED` at
    most. Novelties depend on how far the gestures of a language are apart, so all are measured in
    one language of gestures and candidates.

    """
    size = len(language.gestures)
    others = [at for at, each in enumerate(language.labels) if each != label]
    joined = join_candidates(language, candidates)
    pool = measure_confusions(joined, known, only_seen=len(candidates), advance=advance)
    now = pool.measure_misread(range(size))
    kept = tuple(pair for pair in pool.list_pairs(others) if pair.is_alike)
    found = []
    for at in range(len(candidates)):
        after = pool.measure_misread([*others, size + at])
        compared = [pool.compare(size + at, other) for other in others]
        pairs = [replace(pair, gestures=(label, pair.gestures[1])) for pair in compared]
        nearest = min(pairs, key=lambda pair: pair.distance, default=None)
        alike = (*kept, *(pair for pair in pairs if pair.is_alike))
        found.append(Replacement(at, now, after, nearest, alike, pool.people))
    better = sorted((each for each in found if each.after < now), key=lambda each: each.after)
    return tuple(better[:MOST_PROPOSED])


def measure_confusions(
    language: Language,
    known: Sequence[KnownTake] = (),
    *,
    only_seen: int = 0,
    advance: Callable[[], None] = lambda: None,
) -> Confusions:
    """Measure how often the gestures of a language are mixed up.

    Parameters
    ----------
    language
        The gestures; those without a demonstration are mixed up with none.
    known
        Takes whose gesture is known.
    only_seen
        How many of the last gestures are compared with the others' demonstrations only, not theirs
        with the others, which costs a comparison each.
    advance
        Called after each comparison; an exception that it raises ends the work.

    """
    size = len(language.gestures)
    total, shown = np.zeros((size, size)), np.zeros(size)
    nearest, mixed = np.full((size, size), np.inf), np.zeros((size, size))
    people, rows = compare_people(language, advance)
    labels, recognizer = language.labels, Recognizer(language, "full")
    takes = [(labels.index(each.label), each.query) for each in known if each.label in labels]
    rows += _compare(recognizer, takes, advance)
    compared = np.bincount([own for own, _ in rows], minlength=size).astype(np.float64)
    for own, novelty in rows:
        mixed[own] += novelty < novelty[own]
    # Of gestures that one person has shown and nobody repeated, distances alone are known.
    left = {*range(size - only_seen)} - {own for own, _ in rows}
    demonstrations = [
        (own, condense(gesture.trajectory))
        for own, gesture in enumerate(language.gestures)
        if own in left and gesture.trajectory is not None
    ]
    rows += _compare(recognizer, demonstrations, advance)
    for own, novelty in rows:
        total[own] += np.minimum(np.nan_to_num(novelty, nan=FAR, posinf=FAR), FAR)
        nearest[own] = np.fmin(nearest[own], novelty)
        shown[own] += 1
    apart = np.where(shown[:, None] > 0, total / np.maximum(shown, 1)[:, None], np.nan)
    apart = np.where(np.isnan(apart), apart.T, apart)
    apart = np.nan_to_num(apart, nan=FAR)
    rates = (np.exp(-apart / SPREAD) + np.exp(-apart.T / SPREAD)) / 2
    np.fill_diagonal(rates, 0.0)
    return Confusions(labels, rates, nearest, mixed, compared, max(people, 1))


def _compare(
    recognizer: Recognizer, takes: Iterable[tuple[int, Trajectory]], advance: Callable[[], None]
) -> Iterator[tuple[int, FloatArray]]:
    """Yield the index of the gesture of each take, and its novelty ``(G,)`` for all gestures."""
    for own, take in takes:
        yield own, recognizer.compare(take).novelty
        advance()
