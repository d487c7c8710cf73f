"""Does the health report foresee which gestures get confused? Predicted against observed."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np
import numpy.typing as npt

from app.recognition import Language, Recognizer
from app.recognition.errors import PoseError
from app.recognition.poses import FloatArray
from app.recognition.rehearsal import rehearse
from app.recognition.variation import Person
from benchmarks.recorded_sets import RecordedSet, recorded_sets
from benchmarks.shared_sets import demonstrated

BAR = 0.05
"""Predicted confusion above which the health report warns of a pair."""


@dataclass(frozen=True, eq=False)
class Pairs:
    """Ordered pairs of gestures, several languages' one after the other.

    Attributes
    ----------
    predicted
        ``(N,)`` how often the first is expected to be read as the second.
    observed
        ``(N,)`` how often takes of the first were.
    takes
        ``(N,)`` how many takes of the first there were.

    """

    predicted: FloatArray
    observed: FloatArray
    takes: FloatArray

    def __add__(self, other: Pairs) -> Pairs:
        joined = zip(vars(self).values(), vars(other).values(), strict=True)
        return Pairs(*(np.concatenate(both) for both in joined))

    @property
    def rank_correlation(self) -> float:
        """Spearman's, over all pairs."""
        if np.ptp(self.observed) == 0:
            return float("nan")
        return float(np.corrcoef(_ranks(self.predicted), _ranks(self.observed))[0, 1])

    @property
    def discrimination(self) -> float:
        """How probably a confused pair is predicted above one that was never confused (AUC)."""
        ranks, confused = _ranks(self.predicted), self.observed > 0
        count, rest = confused.sum(), (~confused).sum()
        if not count or not rest:
            return float("nan")
        return float((ranks[confused].sum() - count * (count - 1) / 2) / (count * rest))

    @property
    def foreseen(self) -> tuple[int, int]:
        """Misread takes of warned pairs, and all misread takes."""
        misread = np.round(self.observed * self.takes)
        return int(misread[self.predicted > BAR].sum()), int(misread.sum())

    @property
    def warned(self) -> tuple[int, int]:
        """Pairs warned of, and those of them that were confused."""
        above = self.predicted > BAR
        return int(above.sum()), int((above & (self.observed > 0)).sum())


def _ranks(values: FloatArray) -> FloatArray:
    """Rank ``(N,)`` values from 0, equal ones with their mean rank."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    return np.asarray((last - (counts + 1) / 2 - 0.5 + 0.0)[inverse], dtype=np.float64)


def draws(
    recorded: RecordedSet, person: Person, count: int, takes: int, variants: int, seed: int
) -> Iterator[Pairs]:
    """Teach one person's takes, predict, and let the same person or the others perform."""
    generator = np.random.default_rng(seed)
    for _ in range(count):
        teacher = generator.choice(np.unique(recorded.people))
        own = recorded.people == teacher
        labels = np.unique(recorded.labels)
        templates = [
            int(generator.choice(np.flatnonzero(own & (recorded.labels == label))))
            for label in labels
        ]
        pool = np.setdiff1d(np.flatnonzero(own if person == "same" else ~own), templates)
        if not len(pool):
            return
        recognizer = Recognizer(Language(recorded.name, demonstrated(recorded, templates)), "full")
        yield _pairs(recognizer, recorded, labels, pool, person, takes, variants, generator)


def _pairs(
    recognizer: Recognizer,
    recorded: RecordedSet,
    labels: npt.NDArray[np.str_],
    pool: npt.NDArray[np.intp],
    person: Person,
    takes: int,
    variants: int,
    generator: np.random.Generator,
) -> Pairs:
    rehearsal = rehearse(recognizer, variants, person=person)
    columns: list[Sequence[float]] = []
    for performer, label in enumerate(labels):
        mine = pool[recorded.labels[pool] == label]
        chosen = generator.choice(mine, min(takes, len(mine)), replace=False)
        read = [_nearest(recognizer, recorded, int(query)) for query in chosen]
        columns += [
            (rehearsal.confusion(performer, other).rate, read.count(rival) / len(read), len(read))
            for other, rival in enumerate(labels)
            if other != performer and read
        ]
    return Pairs(*np.array(columns, dtype=np.float64).T)


def _nearest(recognizer: Recognizer, recorded: RecordedSet, query: int) -> str | None:
    try:
        return recognizer.recognize(recorded.recordings[query]).nearest
    except PoseError:
        return None


def main() -> None:
    """Print one line a set and performer."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("--sets", nargs="+", help="names of sets; default: all")
    parser.add_argument("--draws", type=int, default=10, help="languages per set")
    parser.add_argument("--takes", type=int, default=10, help="takes of each gesture")
    parser.add_argument("--variants", type=int, default=24)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    print(f"predicted against observed confusion of ordered pairs, seed {given.seed}")
    for recorded in recorded_sets(given.data / "trajectories"):
        if given.sets and recorded.name not in given.sets:
            continue
        for person in get_args(Person):
            found = list(
                draws(recorded, person, given.draws, given.takes, given.variants, given.seed)
            )
            if not found:
                continue
            pairs = sum(found[1:], start=found[0])
            warned, confused = pairs.warned
            foreseen, misread = pairs.foreseen
            print(
                f"{recorded.name:10} {person:8} n {len(pairs.predicted):5} "
                f"rank {pairs.rank_correlation:5.2f} auc {pairs.discrimination:5.2f} "
                f"mean predicted {pairs.predicted.mean():.2%} observed {pairs.observed.mean():.2%} "
                f"warned {warned} confused {confused} misread {misread} foreseen {foreseen}",
                flush=True,
            )


if __name__ == "__main__":
    main()
