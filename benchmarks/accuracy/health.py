"""Health check: compares its estimates with confusions and misses in real takes.

In each recorded set one take per class by one person makes a language. Simulated trials estimate
its rates, as in `osg-studio check`; then real takes of each gesture are recognised, by the same
person or by others. The estimate for each ordered pair of gestures, and for each gesture, is
compared with the observed rate: by set, and by bins of the estimate.

    python -m benchmarks.accuracy.health ../shared/data
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from app.recognition import Language, Recognizer
from app.recognition.decision.rejection import is_rejected
from app.recognition.decision.score_table import ScoreTable
from app.recognition.errors import PoseError
from app.recognition.health.report import MOST_CONFUSION, MOST_MISSED
from app.recognition.health.simulated_trials import simulate_trials
from app.recognition.poses.sequence import FloatArray
from app.recognition.simulation.variation import Person
from benchmarks.accuracy.shared_sets import demonstrated
from benchmarks.arguments import set_arguments
from benchmarks.sets.recorded_sets import RecordedSet, recorded_sets

BINS = (0.0, 0.02, 0.05, 0.1, 0.2, 1.001)
"""Limits of the bins of estimates; they include the two thresholds of the report."""


@dataclass(frozen=True, eq=False)
class Forecasts:
    """N estimates of one kind, for several languages.

    Attributes
    ----------
    predicted
        ``(N,)`` rates.
    happened, takes
        ``(N,)`` number of real takes with the estimated error, and number of real takes.

    """

    predicted: FloatArray
    happened: FloatArray
    takes: FloatArray

    @classmethod
    def joined(cls, parts: Sequence[Forecasts]) -> Forecasts:
        """Concatenate the estimates of several languages."""
        columns = zip(*(vars(part).values() for part in parts), strict=True)
        return cls(*(np.concatenate(column) for column in columns))

    def within(self, low: float, high: float) -> Forecasts:
        """Return the estimates from `low` to below `high`."""
        kept = (self.predicted >= low) & (self.predicted < high)
        return Forecasts(self.predicted[kept], self.happened[kept], self.takes[kept])

    @property
    def mean(self) -> float:
        """Mean estimate over takes."""
        return float(np.average(self.predicted, weights=self.takes))

    @property
    def observed(self) -> float:
        """Observed rate over takes."""
        return float(self.happened.sum() / self.takes.sum())

    @property
    def slope(self) -> float:
        """Slope of observed rates over estimates: 1 if the estimates are right."""
        weights = self.takes / self.takes.sum()
        apart = self.predicted - self.mean
        shares = self.happened / self.takes - self.observed
        return float((weights * apart * shares).sum() / (weights * apart**2).sum())

    @property
    def rank_correlation(self) -> float:
        """Spearman's rank correlation of estimates and observed rates.

        0 if all observed rates are equal.
        """
        ranks = _ranks(self.predicted), _ranks(self.happened / self.takes)
        if min(float(np.ptp(each)) for each in ranks) == 0:
            return 0.0
        return float(np.corrcoef(*ranks)[0, 1])


@dataclass(frozen=True)
class Study:
    """How languages are drawn.

    Attributes
    ----------
    draws
        Languages per set.
    takes
        Real takes of each gesture.
    variants
        Simulated trials of each gesture.
    seed
        Seed of all random draws.

    """

    draws: int
    takes: int
    variants: int
    seed: int


def study_set(recorded: RecordedSet, person: Person, study: Study) -> tuple[Forecasts, Forecasts]:
    """Compare estimates from one person's demonstrations with takes of that person or of others.

    Returns
    -------
    Estimates of confusions, one per ordered pair, and of misses, one per gesture.

    """
    generator = np.random.default_rng(study.seed)
    labels = np.unique(recorded.labels)
    confusions, misses = [], []
    for _ in range(study.draws):
        own = recorded.people == generator.choice(np.unique(recorded.people))
        templates = [
            int(generator.choice(np.flatnonzero(own & (recorded.labels == label))))
            for label in labels
        ]
        # In a set without people's names, everybody counts as the same person.
        alone = own.all() or person == "same"
        pool = np.setdiff1d(np.flatnonzero(own if alone else ~own), templates)
        recognizer = Recognizer(Language(recorded.name, demonstrated(recorded, templates)))
        rehearsal = simulate_trials(recognizer, study.variants, person=person)
        for performer, label in enumerate(labels):
            mine = pool[recorded.labels[pool] == label]
            chosen = generator.choice(mine, min(study.takes, len(mine)), replace=False)
            read = [*_compare(recognizer, recorded, chosen)]
            nearest = np.array([compared.scores.argmin() for compared in read])
            refused = np.array([is_rejected(compared.novelty[performer]) for compared in read])
            others = np.delete(np.arange(len(labels)), performer)
            estimates = [rehearsal.confusion(performer, int(other)) for other in others]
            confusions.append(
                Forecasts(
                    np.array([each.rate for each in estimates if each is not None]),
                    (nearest[:, None] == others).sum(axis=0).astype(np.float64),
                    np.full(len(others), float(len(read))),
                )
            )
            misses.append(
                Forecasts(
                    np.array([rehearsal.missed(performer).rate]),
                    np.array([float(((nearest != performer) | refused).sum())]),
                    np.array([float(len(read))]),
                )
            )
    return Forecasts.joined(confusions), Forecasts.joined(misses)


def _compare(
    recognizer: Recognizer, recorded: RecordedSet, queries: npt.NDArray[np.intp]
) -> Iterator[ScoreTable]:
    for query in queries:
        try:
            yield recognizer.compare(recognizer.query(recorded.recordings[query]))
        except PoseError:  # nothing moves
            continue


def row(name: str, found: Forecasts, bar: float) -> str:
    """Format a table row: estimates against observed rates."""
    warned = found.within(bar, np.inf)
    came_true = int((warned.happened > 0).sum())
    return (
        f"| {name} | {len(found.predicted)} | {found.mean:.2%} | {found.observed:.2%} | "
        f"{found.slope:.2f} | {found.rank_correlation:.2f} | {len(warned.predicted)} | "
        f"{came_true} | {warned.happened.sum():.0f} of {found.happened.sum():.0f} |"
    )


def calibration(found: Forecasts) -> Iterator[str]:
    """Yield the calibration table: observed rate per bin of estimates."""
    for low, high in pairwise(BINS):
        inside = found.within(low, high)
        if len(inside.predicted):
            yield (
                f"| {low:.0%} to {min(high, 1):.0%} | {len(inside.predicted)} | "
                f"{inside.mean:.1%} | {inside.observed:.1%} of {inside.takes.sum():.0f} |"
            )


def _ranks(values: FloatArray) -> FloatArray:
    """Rank ``(N,)`` values from 0, equal ones with their mean rank."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(counts) - (counts + 1) / 2)[inverse], dtype=np.float64)


def main() -> None:
    """Print one row per set, performer and kind of estimate, then the calibration table."""
    parser = set_arguments(__doc__, draws=10, queries=10)
    parser.add_argument("--variants", type=int, default=16, help="rehearsed takes of each gesture")
    given = parser.parse_args()
    study = Study(given.draws, given.queries, given.variants, given.seed)
    bars = {"pairs": MOST_CONFUSION, "gestures": MOST_MISSED}
    found: dict[tuple[Person, str], list[Forecasts]] = {}
    print("| set, performer | n | predicted | observed | slope | rank | warned | true | foreseen |")
    for recorded in recorded_sets(given.data / "trajectories", given.sets):
        people: tuple[Person, ...] = ("same", "another")
        for person in people if len(np.unique(recorded.people)) > 1 else people[1:]:
            for kind, part in zip(bars, study_set(recorded, person, study), strict=True):
                found.setdefault((person, kind), []).append(part)
                print(row(f"{recorded.name} {person}, {kind}", part, bars[kind]), flush=True)
    for (person, kind), parts in found.items():
        everything = Forecasts.joined(parts)
        print(row(f"all {person}, {kind}", everything, bars[kind]))
        print("\n".join(calibration(everything)))


if __name__ == "__main__":
    main()
