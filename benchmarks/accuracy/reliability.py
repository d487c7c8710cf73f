"""Reliability: calibration of the confidence of profile ``full``, and its rejection rates.

In each recorded set a random half of the classes makes a language, one template each by one person;
queries come from all classes, so that about half of them are out-of-vocabulary. They are by the
same person (UD), and if people are known also by everybody else (UI). Rejected and accepted shares
are printed; averages over the sets are of queries by the same person if people are known.

The limit is compared with one per set, which rejects `REFUSED` of the set's true takes. Intervals
are from the bootstrap over languages (Efron 1979), because queries to one language share its
templates and its missing classes.

    python -m benchmarks.accuracy.reliability ../shared/data --seeds 1 2 3
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise

import numpy as np
import numpy.typing as npt

from app.recognition import Language, PoseError, Recognizer
from app.recognition.poses.sequence import FloatArray
from benchmarks.arguments import set_arguments
from benchmarks.sets.one_shot_draws import demonstrated
from benchmarks.sets.recorded_sets import RecordedSet, recorded_sets

REFUSED = 0.05
"""Share of the true takes rejected at the set's own limit."""

RESAMPLES = 1000
"""Bootstrap samples: with these the ends of a 95 % interval vary by a tenth of its width."""

BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0001)


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
    def own_limit(self) -> float:
        """The novelty that rejects `REFUSED` of the true takes if it is the limit."""
        return float(np.quantile(self.novelty[self.known], 1 - REFUSED))

    def accepted_at(self, novelty: float) -> float:
        """Return the share of out-of-vocabulary movements of at most this novelty."""
        return float((self.novelty[~self.known] <= novelty).mean())


Statistic = Callable[[Sequence[Outcomes]], float]


def accepted_at_own_limits(sets: Sequence[Outcomes]) -> float:
    """Return the share accepted, averaged over the sets, each with its own limit."""
    return float(np.mean([each.accepted_at(each.own_limit) for each in sets]))


def refused_by_limit(sets: Sequence[Outcomes]) -> float:
    """Return the share of true takes rejected, averaged over the sets."""
    return float(np.mean([each.true_refused for each in sets]))


def accepted_by_limit(sets: Sequence[Outcomes]) -> float:
    """Return the share of out-of-vocabulary movements accepted, averaged over the sets."""
    return float(np.mean([each.foreign_accepted for each in sets]))


def with_interval(statistic: Statistic, sets: Sequence[Outcomes]) -> str:
    """Return a statistic and its 95 % interval as text."""
    generator = np.random.default_rng(0)
    drawn = [statistic([each.resampled(generator) for each in sets]) for _ in range(RESAMPLES)]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return f"{statistic(sets):.1%} ({low:.1%} to {high:.1%})"


STATISTICS = {
    "foreign accepted, each set with its own limit": accepted_at_own_limits,
    "true refused by the limit": refused_by_limit,
    "foreign accepted by the limit": accepted_by_limit,
}


@dataclass(frozen=True)
class Answer:
    """One query's outcome.

    Attributes
    ----------
    language
        Number of the language that recognised the query.
    confidence, novelty
        Of the nearest gesture.
    known
        Whether the query's gesture was in the language.
    correct
        Whether this gesture was the nearest one.
    refused
        Whether the query was rejected.

    """

    language: int
    confidence: float
    novelty: float
    known: bool
    correct: bool
    refused: bool


def answers(
    recorded: RecordedSet, draws: int, queries: int, seed: int, *, same_person: bool
) -> Iterator[Answer]:
    """Return queries by the person of the templates, or by all others."""
    random = np.random.default_rng(seed)
    classes = np.unique(recorded.labels)
    for number in range(draws):
        chosen = random.permutation(classes)[: len(classes) // 2 + 1]
        own = recorded.people == random.choice(np.unique(recorded.people))
        templates = [
            int(random.choice(np.flatnonzero(own & (recorded.labels == label)))) for label in chosen
        ]
        language = Language(recorded.name, demonstrated(recorded, templates))
        recognizer = Recognizer(language, "full")
        pool = np.setdiff1d(np.flatnonzero(own == same_person), templates)
        for query in random.choice(pool, min(queries, len(pool)), replace=False):
            label = str(recorded.labels[query])
            try:
                result = recognizer.recognize(recorded.recordings[query])
            except PoseError:
                continue
            yield Answer(
                language=number + seed * draws,
                confidence=result.confidence,
                novelty=float(result.novelty[result.gestures.index(result.nearest)]),
                known=label in language.labels,
                correct=result.nearest == label,
                refused=result.outcome == "rejected",
            )


def outcomes(asked: Sequence[Answer]) -> Outcomes:
    """Convert the answers of one set to arrays."""
    return Outcomes(
        np.array([answer.novelty for answer in asked]),
        np.array([answer.known for answer in asked]),
        np.array([answer.refused for answer in asked]),
        np.array([answer.language for answer in asked]),
    )


def row(name: str, asked: Sequence[Answer]) -> str:
    """Format a table row: rejected and accepted shares of one set."""
    found = outcomes(asked)
    known = int(found.known.sum())
    return (
        f"| {name} | {found.accepted_at(found.own_limit):.1%} | "
        f"{found.true_refused:.1%} of {known} | "
        f"{found.foreign_accepted:.1%} of {len(asked) - known} |"
    )


def reliability(asked: Sequence[Answer]) -> Iterator[str]:
    """Write the reliability table, row by row."""
    for low, high in pairwise(BINS):
        inside = [answer for answer in asked if low <= answer.confidence < high]
        if inside:
            mean = np.mean([answer.confidence for answer in inside])
            correct = np.mean([answer.correct for answer in inside])
            bin_name = f"{low:.1f} to {min(high, 1):.1f}"
            yield f"| {bin_name} | {len(inside)} | {mean:.2f} | {correct:.2f} |"


def main() -> None:
    """Print the reliability table, then rejected and accepted shares per set and on average."""
    parser = set_arguments(__doc__, draws=20, queries=30)
    parser.add_argument("--seeds", type=int, nargs="+", help="several instead of one")
    given = parser.parse_args()
    seeds = given.seeds or [given.seed]
    everything: list[Answer] = []
    averaged: list[list[list[Answer]]] = [[] for _ in seeds]
    print("| set | accepted at 5 % refused | true refused | foreign accepted |")
    for recorded in recorded_sets(given.data / "trajectories", given.sets):
        alone = len(np.unique(recorded.people)) == 1
        for same_person in (True,) if alone else (True, False):
            by_seed = [
                [*answers(recorded, given.draws, given.queries, seed, same_person=same_person)]
                for seed in seeds
            ]
            asked = [answer for part in by_seed for answer in part]
            print(row(f"{recorded.name} {'UD' if same_person else 'UI'}", asked), flush=True)
            everything += asked
            if same_person:
                for sets, part in zip(averaged, by_seed, strict=True):
                    sets.append(part)
    pooled = [outcomes([*chain.from_iterable(parts)]) for parts in zip(*averaged, strict=True)]
    for name, statistic in STATISTICS.items():
        each = ", ".join(f"{statistic([outcomes(part) for part in sets]):.1%}" for sets in averaged)
        print(f"{name}: {with_interval(statistic, pooled)}; seed by seed {each}", flush=True)
    print("| confidence | queries | mean confidence | share correct |")
    print("\n".join(reliability(everything)))


if __name__ == "__main__":
    main()
