"""One-shot draws: random choice of demonstrations, by one person or several, and of queries."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition import Gesture
from benchmarks.methods.ours import teach
from benchmarks.sets.recorded_sets import RecordedSet


@dataclass(frozen=True, eq=False)
class Draw:
    """One language and its queries, as indices of recordings.

    Attributes
    ----------
    templates
        One of each class, all by one person.
    own, others
        Queries by the same person and by everybody else.

    """

    templates: list[int]
    own: npt.NDArray[np.intp]
    others: npt.NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class SeveralPeople:
    """Further demonstrations of a drawn language, and queries, as indices of recordings.

    Attributes
    ----------
    takes
        Per person who demonstrates, and per class, one take or two; each person's first one counts
        as that person's demonstration. The first person and these takes are those of the draw.
    half
        A random half of the classes, at least two.
    queries
        By people of whom there is no take in `takes`; by anybody if only one person is known.

    """

    takes: list[list[list[int]]]
    half: frozenset[str]
    queries: npt.NDArray[np.intp]

    def rows(self, people: int, takes: int = 1) -> list[list[int]]:
        """Return for each class the first `takes` takes by each of the first `people` people."""
        shown = [[taken[:takes] for taken in person] for person in self.takes[:people]]
        return [[take for taken in row for take in taken] for row in zip(*shown, strict=True)]


def draws(recorded: RecordedSet, count: int, queries: int, seed: int) -> Iterator[Draw]:
    """Draw `count` languages with up to `queries` queries of each kind, reproducibly by seed.

    People who lack a class demonstrate nothing; without other people there are no languages.
    """
    generator = np.random.default_rng(seed)
    complete = find_complete_people(recorded)
    for _ in range(count if len(complete) else 0):
        person = generator.choice(complete)
        own = recorded.people == person
        templates = [
            int(generator.choice(np.flatnonzero(own & (recorded.labels == label))))
            for label in np.unique(recorded.labels)
        ]
        pools = (np.setdiff1d(np.flatnonzero(own), templates), np.flatnonzero(~own))
        chosen = [generator.choice(pool, min(queries, len(pool)), replace=False) for pool in pools]
        yield Draw(templates, chosen[0], chosen[1])


def draw_several(
    recorded: RecordedSet, chosen: Draw, most: int, queries: int, seed: int
) -> SeveralPeople:
    """Draw up to `most` people who demonstrate, but leave one to ask, and up to `queries` queries.

    The first of them demonstrates `chosen`.
    """
    generator = np.random.default_rng(seed)
    first = recorded.people[chosen.templates[0]]
    everyone = np.unique(recorded.people)
    complete = find_complete_people(recorded)
    most_others = max(0, min(most, len(everyone) - 1) - 1)
    others = generator.permutation(complete[complete != first])[:most_others]
    classes = np.unique(recorded.labels)
    takes = []
    for person in (first, *others):
        own = [
            np.flatnonzero((recorded.people == person) & (recorded.labels == label))
            for label in classes
        ]
        takes.append([[int(take) for take in generator.permutation(each)[:2]] for each in own])
    for row, template in zip(takes[0], chosen.templates, strict=True):
        row[:] = [template, *(take for take in row if take != template)][:2]
    if len(everyone) > 1:
        pool = np.flatnonzero(~np.isin(recorded.people, [first, *others]))
    else:
        shown = [take for row in takes[0] for take in row]
        pool = np.setdiff1d(np.arange(len(recorded.people)), shown)
    half = generator.choice(classes, max(2, len(classes) // 2), replace=False)
    asked = generator.choice(pool, min(queries, len(pool)), replace=False)
    return SeveralPeople(takes, frozenset(map(str, half)), asked)


def demonstrated(recorded: RecordedSet, takes: Sequence[int]) -> list[Gesture]:
    """Make a gesture of each take of a set."""
    return [teach([each]) for each in recorded.show(takes)]


def find_complete_people(recorded: RecordedSet) -> npt.NDArray[np.str_]:
    """Return the people of whom there is a take of every class, sorted."""
    everyone = np.unique(recorded.people)
    classes = len(np.unique(recorded.labels))
    shown = [len(np.unique(recorded.labels[recorded.people == person])) for person in everyone]
    return np.asarray(everyone[np.array(shown) == classes])
