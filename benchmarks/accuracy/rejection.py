"""Rejection rates: out-of-vocabulary movements accepted and true takes rejected.

Three thresholds of the novelty are compared: one per set, which rejects `REFUSED` of the set's true
takes; a common one, which rejects `REFUSED` on average over the sets; and the calibrated one of
each language. Intervals are from the bootstrap over languages (Efron 1979), because queries to one
language share its templates and its missing classes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import FloatArray

REFUSED = 0.05
"""Share of the true takes rejected at the thresholds for which false acceptance is reported."""

RESAMPLES = 1000
"""Bootstrap samples: with these the ends of a 95 % interval vary by a tenth of its width."""


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
        ``(N,)`` whether the query was rejected.
    language
        ``(N,)`` number of the language that recognised the query.

    """

    novelty: FloatArray
    known: npt.NDArray[np.bool_]
    refused: npt.NDArray[np.bool_]
    language: npt.NDArray[np.intp]

    def resampled(self, generator: np.random.Generator) -> Outcomes:
        """Draw the same number of languages with replacement, each with all of its queries."""
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
        """The share of true takes that the language rejected."""
        return float(self.refused[self.known].mean())

    @property
    def foreign_accepted(self) -> float:
        """The share of out-of-vocabulary movements that the language accepted."""
        return float((~self.refused[~self.known]).mean())

    @property
    def own_bar(self) -> float:
        """The threshold that rejects `REFUSED` of the true takes."""
        return float(np.quantile(self.novelty[self.known], 1 - REFUSED))

    def accepted_at(self, bar: float) -> float:
        """Return the share of out-of-vocabulary movements at or below a threshold."""
        return float((self.novelty[~self.known] <= bar).mean())


Statistic = Callable[[Sequence[Outcomes]], float]


def accepted_at_own_bars(sets: Sequence[Outcomes]) -> float:
    """Return the share accepted, averaged over the sets, each with its own threshold."""
    return float(np.mean([each.accepted_at(each.own_bar) for each in sets]))


def accepted_at_one_bar(sets: Sequence[Outcomes]) -> float:
    """Return the mean share accepted at the threshold that rejects `REFUSED` on average."""
    true = np.concatenate([each.novelty[each.known] for each in sets])
    counted = [int(each.known.sum()) for each in sets]
    weight = np.concatenate([np.full(count, 1 / count / len(sets)) for count in counted])
    order = np.argsort(true)
    bar = float(true[order][np.searchsorted(np.cumsum(weight[order]), 1 - REFUSED)])
    return float(np.mean([each.accepted_at(bar) for each in sets]))


def refused_as_calibrated(sets: Sequence[Outcomes]) -> float:
    """Return the share of true takes rejected, averaged over the sets."""
    return float(np.mean([each.true_refused for each in sets]))


def accepted_as_calibrated(sets: Sequence[Outcomes]) -> float:
    """Return the share of out-of-vocabulary movements accepted, averaged over the sets."""
    return float(np.mean([each.foreign_accepted for each in sets]))


def with_interval(statistic: Statistic, sets: Sequence[Outcomes]) -> str:
    """Return a statistic and its 95 % interval as text."""
    generator = np.random.default_rng(0)
    drawn = [statistic([each.resampled(generator) for each in sets]) for _ in range(RESAMPLES)]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return f"{statistic(sets):.1%} ({low:.1%} to {high:.1%})"
