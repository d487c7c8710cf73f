"""Reliability: calibration of the confidence of profile ``full``, and its rejection rates.

In each recorded set a random half of the classes makes a language, one template each by one person;
half of the queries are of these classes, half of the others, out-of-vocabulary. They are by the
same person (UD), and if people are known also by everybody else (UI). Rejected and accepted shares
are printed; averages over the sets are of queries by the same person if people are known.

The limit is compared with one per set, which rejects `REFUSED` of the set's true takes. Intervals
are from the bootstrap over languages (Efron 1979), because queries to one language share its
templates and its missing classes.

With ``--fit`` instead, of all sets, also of whole bodies, and also of languages that three people
show: the coefficients of the confidence by logistic regression, the table of the shipped ones, that
of those fitted without the set and the person of each query, and those of two kinds of queries. `!`
marks a bin of `FEWEST` queries or more that is certainly more than `FAR_OFF` away.

    python -m benchmarks.accuracy.reliability ../shared/data --seeds 1 2
    python -m benchmarks.accuracy.reliability ../shared/data --seeds 1 2 --fit
"""

from __future__ import annotations

import math
from argparse import Namespace
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, pairwise
from typing import Final

import numpy as np
import numpy.typing as npt

from app.evaluation.share import Share
from app.recognition import Language, PoseError, Recognizer
from app.recognition.decision.outcome import (
    CONFIDENCE_AT_ZERO,
    CONFIDENCE_PER_DISTANCE,
    bound_confidence,
    sum_distances,
)
from app.recognition.poses.sequence import FloatArray
from benchmarks.accuracy.people import all_sets, define
from benchmarks.arguments import set_arguments
from benchmarks.sets.one_shot_draws import find_complete_people
from benchmarks.sets.recorded_sets import RecordedSet, recorded_sets

REFUSED = 0.05
"""Share of the true takes rejected at the set's own limit."""

RESAMPLES = 1000
"""Bootstrap samples: with these the ends of a 95 % interval vary by a tenth of its width."""

BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0001)

FEWEST: Final = 200
"""Queries of a bin from which it is judged."""

FAR_OFF: Final = 0.04
"""Largest difference of mean confidence and share correct that the confidence may have in a bin."""

NEWTON_ROUNDS: Final = 30
"""Steps of Newton's method; logistic regression converges in about ten."""


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
    recorded
        Name of the set.
    language
        Number of the language that recognised the query.
    people
        Who shows the language, and who made the query last.
    confidence, novelty
        Of the nearest gesture.
    distance
        Its sum of distances, the regressor of the confidence.
    known
        Whether the query's gesture was in the language.
    correct
        Whether this gesture was the nearest one.
    answers
        How many gestures the answer has; none: the query was rejected.

    """

    recorded: str
    language: int
    people: tuple[str, ...]
    confidence: float
    novelty: float
    distance: float
    known: bool
    correct: bool
    answers: int


def answers(
    recorded: RecordedSet,
    draws: int,
    queries: int,
    seed: int,
    *,
    same_person: bool,
    shown_by: int = 1,
) -> Iterator[Answer]:
    """Return queries by the people of the templates, or by all others; `shown_by`: how many."""
    random = np.random.default_rng(seed)
    classes = np.unique(recorded.labels)
    for number in range(draws):
        chosen = random.permutation(classes)[: len(classes) // 2 + 1]
        people = random.choice(find_complete_people(recorded), shown_by, replace=False)
        templates = [
            [
                int(random.choice(np.flatnonzero((recorded.people == each) & of_label)))
                for each in people
            ]
            for of_label in (recorded.labels == label for label in chosen)
        ]
        gestures = [define(recorded, takes) for takes in templates]
        recognizer = Recognizer(Language(recorded.name, gestures), "full")
        asked = np.flatnonzero(np.isin(recorded.people, people) == same_person)
        asked = np.setdiff1d(asked, templates)
        known = np.isin(recorded.labels[asked], chosen)
        count = min(queries // 2, int(known.sum()), int((~known).sum()))
        for query in chain(
            *(random.choice(asked[of], count, replace=False) for of in (known, ~known))
        ):
            label = str(recorded.labels[query])
            try:
                result = recognizer.recognize(recorded.recordings[query])
            except PoseError:
                continue
            novelty = float(result.novelty[result.gestures.index(result.nearest)])
            nearest, second = np.sort(result.scores)[:2].tolist()
            yield Answer(
                recorded=recorded.name,
                language=number + seed * draws,
                people=(*people.tolist(), str(recorded.people[query])),
                confidence=result.confidence,
                novelty=novelty,
                distance=sum_distances(novelty, nearest, second),
                known=label in chosen,
                correct=result.nearest == label,
                answers=1 if result.label else 2 if result.pair else 0,
            )


def outcomes(asked: Sequence[Answer]) -> Outcomes:
    """Convert the answers of one set to arrays."""
    return Outcomes(
        np.array([answer.novelty for answer in asked]),
        np.array([answer.known for answer in asked]),
        np.array([answer.answers == 0 for answer in asked]),
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
            mean = float(np.mean([answer.confidence for answer in inside]))
            share = Share(sum(answer.correct for answer in inside), len(inside))
            least, most = share.interval() or (0.0, 1.0)
            off = len(inside) >= FEWEST and not least - FAR_OFF <= mean <= most + FAR_OFF
            bin_name = f"{low:.1f} to {min(high, 1):.1f}"
            yield f"| {bin_name} | {len(inside)} | {mean:.2f} | {share}{' !' * off} |"


def fit_confidence(asked: Sequence[Answer]) -> FloatArray:
    """Fit the coefficients ``(2,)`` of the confidence, by logistic regression."""
    distances = np.array([answer.distance for answer in asked])
    correct = np.array([answer.correct for answer in asked])
    known = np.stack([np.ones_like(distances), distances], axis=1)
    coefficients = np.zeros(2)
    for _ in range(NEWTON_ROUNDS):
        chance = 1.0 / (1.0 + np.exp(-known @ coefficients))
        curvature = (known.T * (chance * (1 - chance))) @ known
        coefficients += np.linalg.solve(curvature, known.T @ (correct - chance))
    return coefficients


def leave_out(asked: Sequence[Answer]) -> Iterator[Answer]:
    """Yield the answers with confidences fitted without their set and who made the query.

    Prints the range of the coefficients without each set.
    """
    parts = defaultdict[str, defaultdict[str, list[Answer]]](lambda: defaultdict(list))
    for answer in asked:
        parts[answer.recorded][answer.people[-1]].append(answer)
    for name, by_person in parts.items():
        fitted = {
            person: fit_confidence(
                [each for each in asked if each.recorded != name and person not in each.people]
            )
            for person in by_person
        }
        low, high = (of([*fitted.values()], axis=0).round(2).tolist() for of in (np.min, np.max))
        print(f"without {name} and one of its people: {low} to {high}", flush=True)
        for person, part in by_person.items():
            for answer in part:
                odds = float(fitted[person] @ (1.0, answer.distance))
                confidence = 1.0 / (1.0 + math.exp(min(-odds, 700.0)))
                bounded = bound_confidence(confidence, answer.answers, answer.novelty)
                yield replace(answer, confidence=bounded)


def print_fit(given: Namespace, seeds: Sequence[int]) -> None:
    """Print the coefficients of the confidence, and the tables of the shipped and the left out."""
    asked = [
        answer
        for recorded in all_sets(given.data / "trajectories", given.sets)
        for same, people in ((True, 1), (False, 1), (False, 3))
        if same or len(np.unique(recorded.people)) > people
        for seed in seeds
        for answer in answers(
            recorded, given.draws, given.queries, seed, same_person=same, shown_by=people
        )
    ]
    shipped = np.array([CONFIDENCE_AT_ZERO, CONFIDENCE_PER_DISTANCE])
    print(f"of all sets {fit_confidence(asked).round(2).tolist()}, shipped {shipped.tolist()}")
    tables = {
        "shipped": asked,
        "set and person left out": [*leave_out(asked)],
        "shipped, same person": [each for each in asked if each.people[-1] in each.people[:-1]],
        "shipped, shown by three": [each for each in asked if len(each.people) > 2],
    }
    for name, judged in tables.items():
        print(f"| {name} | queries | mean confidence | share correct |")
        print("\n".join(reliability(judged)))


def main() -> None:
    """Print the reliability table, then rejected and accepted shares per set and on average."""
    parser = set_arguments(__doc__, draws=20, queries=30)
    parser.add_argument("--seeds", type=int, nargs="+", help="several instead of one")
    parser.add_argument("--fit", action="store_true", help="coefficients of the confidence alone")
    given = parser.parse_args()
    seeds = given.seeds or [given.seed]
    if given.fit:
        print_fit(given, seeds)
        return
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
