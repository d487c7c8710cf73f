"""Rejection rates: out-of-vocabulary movements accepted and true takes rejected.

A bar on the novelty can stand in three places: where it refuses `REFUSED` of the true takes of
each set by itself, where one and the same bar refuses `REFUSED` on average over the sets, or where
the language was calibrated to. Intervals are those of the bootstrap over languages (Efron 1979):
queries of one language share its templates, and which classes it lacks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import FloatArray

REFUSED = 0.05
"""Share of the true takes refused where false acceptance is reported."""

RESAMPLES = 1000
"""Bootstrap samples: the ends of an interval of 95 % then stray by a tenth of its width."""


@dataclass(frozen=True, eq=False)
class Outcomes:
    """Outcomes of N queries to languages of one set.

    Attributes
    ----------
    novelty
        ``(N,)`` of the nearest gesture.
    known
        ``(N,)`` whether the query's gesture was in the language.
    refused
        ``(N,)`` whether it was read as no gesture.
    language
        ``(N,)`` number of the language that was asked.

    """

    novelty: FloatArray
    known: npt.NDArray[np.bool_]
    refused: npt.NDArray[np.bool_]
    language: npt.NDArray[np.intp]

    def resampled(self, generator: np.random.Generator) -> Outcomes:
        """Draw as many languages with replacement, each with all of its queries."""
        languages, counts = np.unique(self.language, return_counts=True)
        starts = np.concatenate([[0], np.cumsum(counts)])
        order = np.argsort(self.language, kind="stable")
        drawn = generator.integers(len(languages), size=len(languages))
        chosen = np.concatenate([order[starts[one] : starts[one + 1]] for one in drawn])
        return Outcomes(
            *(values[chosen] for values in (self.novelty, self.known, self.refused, self.language))
        )

    @property
    def true_refused(self) -> float:
        """The share of true takes that the language refused."""
        return float(self.refused[self.known].mean())

    @property
    def foreign_accepted(self) -> float:
        """The share of foreign movements that the language accepted."""
        return float((~self.refused[~self.known]).mean())

    @property
    def own_bar(self) -> float:
        """The threshold that refuses `REFUSED` of the true takes."""
        return float(np.quantile(self.novelty[self.known], 1 - REFUSED))

    def accepted_at(self, bar: float) -> float:
        """Return the share of out-of-vocabulary movements at or below a threshold."""
        return float((self.novelty[~self.known] <= bar).mean())


Statistic = Callable[[Sequence[Outcomes]], float]


def accepted_at_own_bars(sets: Sequence[Outcomes]) -> float:
    """Average over the sets, each with its own threshold."""
    return float(np.mean([each.accepted_at(each.own_bar) for each in sets]))


def accepted_at_one_bar(sets: Sequence[Outcomes]) -> float:
    """Average over the sets, all with the threshold that refuses `REFUSED` on average."""
    true = np.concatenate([each.novelty[each.known] for each in sets])
    counted = [int(each.known.sum()) for each in sets]
    weight = np.concatenate([np.full(count, 1 / count / len(sets)) for count in counted])
    order = np.argsort(true)
    bar = float(true[order][np.searchsorted(np.cumsum(weight[order]), 1 - REFUSED)])
    return float(np.mean([each.accepted_at(bar) for each in sets]))


def refused_as_calibrated(sets: Sequence[Outcomes]) -> float:
    """Average over the sets of the true takes refused."""
    return float(np.mean([each.true_refused for each in sets]))


def accepted_as_calibrated(sets: Sequence[Outcomes]) -> float:
    """Average over the sets of the foreign movements accepted."""
    return float(np.mean([each.foreign_accepted for each in sets]))


def with_interval(statistic: Statistic, sets: Sequence[Outcomes]) -> str:
    """Write a statistic with its interval, 95 %."""
    generator = np.random.default_rng(0)
    drawn = [statistic([each.resampled(generator) for each in sets]) for _ in range(RESAMPLES)]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return f"{statistic(sets):.1%} ({low:.1%} to {high:.1%})"
