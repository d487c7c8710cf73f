"""One-shot draws: random choice of demonstrations and queries."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

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


def draws(recorded: RecordedSet, count: int, queries: int, seed: int) -> Iterator[Draw]:
    """Draw `count` languages with up to `queries` queries of each kind, reproducibly by seed."""
    generator = np.random.default_rng(seed)
    for _ in range(count):
        person = generator.choice(np.unique(recorded.people))
        own = recorded.people == person
        templates = [
            int(generator.choice(np.flatnonzero(own & (recorded.labels == label))))
            for label in np.unique(recorded.labels)
        ]
        pools = (np.setdiff1d(np.flatnonzero(own), templates), np.flatnonzero(~own))
        chosen = [generator.choice(pool, min(queries, len(pool)), replace=False) for pool in pools]
        yield Draw(templates, chosen[0], chosen[1])
