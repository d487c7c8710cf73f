"""Variation: compares simulated variants with people's further takes.

In each recorded set, random pairs of takes of one class are drawn: a demonstration and a further
take, by the same person, another one, or anybody if the set does not name people. The further takes
are compared with variants of the demonstration, or with other further takes ("people": differences
by chance).

models
    Kolmogorov and Smirnov's largest difference of cumulative distributions, averaged over the
    voters and over the looks, with a bootstrap interval; the area under the curve of a classifier
    that tells variants from real takes by the voters' distances, and by the looks.
voters
    Quantiles per voter, of real takes and of our variants, and how many real takes lie within 95 %
    of their demonstration's variants.
confusion
    Accuracy of the recogniser on real takes and on variants of the demonstrations.
refused
    Share of real takes, and of variants, rejected by a language with the demonstration as its only
    gesture.
scale
    Mean difference of the voters' distributions with our spreads scaled, and the scale that the
    other sets would choose for each.

    python -m benchmarks.simulation.variation ../shared/data models voters confusion refused scale
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.evaluation.share import Share
from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.outcome import is_rejected
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import Person
from app.recognition.voters.registry import VOTER_NAMES
from benchmarks.sets.one_shot_draws import demonstrated, draws
from benchmarks.sets.recorded_sets import RecordedSet, recorded_sets
from benchmarks.simulation.take_comparison import FEATURES, LOOKS, TakeComparison, demonstration_of
from benchmarks.simulation.two_samples import coverage, kolmogorov_smirnov, separability
from benchmarks.simulation.variation_models import MODELS, Model, ours, scaled

ARTEFACTS = {"natops": ("tempo", "duration")}
"""Features that a set's authors normalised away: the number of frames."""

SCALES = (0.7, 0.85, 1.0, 1.2, 1.4)
QUANTILES = (10, 50, 90)
RESAMPLES = 200
QUERIES = 24


@dataclass(frozen=True)
class Relation:
    """A set with a choice of second takes: by the same person, another person or anyone."""

    recorded: RecordedSet
    kind: str

    def __str__(self) -> str:
        return f"{self.recorded.name:9} {self.kind:8}"

    @property
    def person(self) -> Person:
        """Person model of the variants to compare with."""
        return "same" if self.kind == "same" else "another"

    @property
    def measured(self) -> npt.NDArray[np.bool_]:
        """Which features the set can show, ``(F,)``."""
        return ~np.isin(FEATURES, ARTEFACTS.get(self.recorded.name, ()))

    def others(self, first: int) -> npt.NDArray[np.intp]:
        """Return the further takes of the same class as the first."""
        recorded = self.recorded
        others = recorded.labels == recorded.labels[first]
        if self.kind != "anybody":
            others &= (recorded.people == recorded.people[first]) == (self.kind == "same")
        others[first] = False
        return np.flatnonzero(others)


def list_relations(folder: Path, names: list[str] | None) -> Iterator[Relation]:
    """Return the relations that the named sets can show."""
    for recorded in recorded_sets(folder / "trajectories"):
        if not names or recorded.name in names:
            known = len(np.unique(recorded.people)) > 1
            for kind in ("same", "another") if known else ("anybody",):
                yield Relation(recorded, kind)


@dataclass(frozen=True, eq=False)
class Comparison:
    """Features of N further takes, ``(N, F)``, and of M variants of each demonstration."""

    real: FloatArray
    varied: FloatArray

    def resampled(self, rows: npt.NDArray[np.intp]) -> Comparison:
        """Return some of the pairs."""
        return Comparison(self.real[rows], self.varied[rows])

    def differences(self, names: tuple[str, ...]) -> float:
        """Average Kolmogorov and Smirnov's difference over features that vary at all."""
        columns = [FEATURES.index(name) for name in names]
        return float(
            np.mean(
                [
                    kolmogorov_smirnov(self.real[:, column], self.varied[..., column].ravel())
                    for column in columns
                    if np.isfinite(self.real[:, column]).all() and np.ptp(self.real[:, column]) > 0
                ]
            )
        )

    def separability(self, names: tuple[str, ...]) -> float:
        """Area under the curve of a classifier of variants against further takes."""
        columns = [FEATURES.index(name) for name in names]
        real, varied = self.real[:, columns], self.varied[:, 0, columns]
        return separability(_even_out(real, names), _even_out(varied, names))


def _even_out(sample: FloatArray, names: tuple[str, ...]) -> FloatArray:
    """Take logarithms of distances (looks are logarithms already); missing values become 0."""
    logarithms = np.log(np.clip(np.where(np.isfinite(sample), sample, 0.0), 0.0, None) + 1e-3)
    return np.where(np.isin(names, LOOKS), sample, logarithms)


def compared(
    relation: Relation, model: Model | None, pairs: int, count: int, seed: int
) -> Comparison:
    """Compare further takes and variants with demonstrations drawn at random; None: people."""
    random = np.random.default_rng(seed)
    recordings = relation.recorded.recordings
    real, varied = [], []
    for number in range(pairs):
        first = int(random.integers(len(recordings)))
        takes = random.permutation(relation.others(first))[: count + 1]
        comparison = TakeComparison(demonstrated(relation.recorded, [first])[0])
        real.append(comparison.of_recording(recordings[takes[0]]))
        if model is None:
            others = [comparison.of_recording(recordings[take]) for take in takes[1:]]
        else:
            drawn = model(comparison.demonstration, count, seed + number, relation.person)
            others = [comparison.features(condense(take)) for take in drawn]
        varied.append(others)
    return Comparison(np.array(real), np.array(varied))


def report_models(relation: Relation, pairs: int, count: int, seed: int) -> Iterator[str]:
    """Report the difference between each model's variants and people's takes."""
    yield "set | model | voters differ | looks differ | told by voters | by looks"
    voters = tuple(name for name in VOTER_NAMES if relation.measured[FEATURES.index(name)])
    seen = tuple(name for name in LOOKS if relation.measured[FEATURES.index(name)])
    for name, model in {"people": None, **MODELS}.items():
        found = compared(relation, model, pairs, count, seed)
        random = np.random.default_rng(seed)
        resamples = [
            found.resampled(random.integers(0, pairs, pairs)).differences(voters)
            for _ in range(RESAMPLES)
        ]
        yield (
            f"{relation} | {name:8} | {found.differences(voters):.2f} "
            f"(+-{1.96 * np.std(resamples):.2f}) | {found.differences(seen):.2f} | "
            f"{found.separability(voters):.2f} | {found.separability(seen):.2f}"
        )


def report_voters(relation: Relation, pairs: int, count: int, seed: int) -> Iterator[str]:
    """Report quantiles of real and varied takes, feature by feature."""
    found = compared(relation, ours, pairs, count, seed)
    yield f"set | voter | real {QUANTILES} % | varied | differ | covered"
    for index, name in enumerate(FEATURES):
        real, varied = found.real[:, index], found.varied[..., index]
        if np.isfinite(real).all() and np.ptp(real) > 0 and relation.measured[index]:
            cells = [
                " ".join(f"{value:6.3f}" for value in np.percentile(sample, QUANTILES))
                for sample in (real, varied.ravel())
            ]
            yield (
                f"{relation} | {name:16} | {cells[0]} | {cells[1]} | "
                f"{kolmogorov_smirnov(real, varied.ravel()):.2f} | {coverage(real, varied):.0%}"
            )


def report_confusion(relation: Relation, pairs: int, _: int, seed: int) -> Iterator[str]:
    """Report the confusions of real takes and of variants in a language of all classes."""
    recorded = relation.recorded
    real, variants = Share(0, 0), Share(0, 0)
    for draw in draws(recorded, max(1, pairs // QUERIES), QUERIES, seed):
        gestures = demonstrated(recorded, draw.templates)
        vote = FusedVote(gestures)
        queries = draw.others if relation.kind == "another" else draw.own
        for number, query in enumerate(queries):
            take = condense(Trajectory.from_poses(recorded.recordings[query]))
            real += _named(vote, take, str(recorded.labels[query]))
            gesture = gestures[number % len(gestures)]
            drawn = ours(demonstration_of(gesture), 1, int(query), relation.person)
            variants += _named(vote, condense(drawn[0]), gesture.label)
    yield f"{relation} | real {real} | variants {variants} | n = {real.asked}"


def _named(vote: FusedVote, take: Trajectory, label: str) -> Share:
    result = vote.recognize(take)
    return Share(int(result is not None and result.nearest == label), 1)


def report_refusals(relation: Relation, pairs: int, count: int, seed: int) -> Iterator[str]:
    """Report how many real takes and variants lie beyond the limit of a single demonstration."""
    random = np.random.default_rng(seed)
    recordings = relation.recorded.recordings
    real, varied = Share(0, 0), Share(0, 0)
    for number in range(pairs):
        first = int(random.integers(len(recordings)))
        takes = random.permutation(relation.others(first))[:count]
        gestures = demonstrated(relation.recorded, [first])
        vote = FusedVote(gestures)
        for take in takes:
            real += _refused(vote, Trajectory.from_poses(recordings[take]))
        drawn = ours(demonstration_of(gestures[0]), count, seed + number, relation.person)
        for variant in drawn:
            varied += _refused(vote, variant)
    yield f"{relation} | real {real} of {real.asked} | variants {varied} of {varied.asked}"


def _refused(vote: FusedVote, take: Trajectory) -> Share:
    compared = vote.compare(condense(take))
    return Share(int(is_rejected(float(compared.novelty[0]))), 1)


def scale(every: list[Relation], pairs: int, count: int, seed: int) -> Iterator[str]:
    """Report the fit of scaled spreads, and the scale chosen without each set."""
    misfit = np.array(
        [
            [
                compared(relation, scaled(factor), pairs, count, seed).differences(
                    tuple(name for name in VOTER_NAMES if relation.measured[FEATURES.index(name)])
                )
                for factor in SCALES
            ]
            for relation in every
        ]
    )
    yield f"set | differ at scale {SCALES} | chosen without the set | differ there"
    for relation, row in zip(every, misfit, strict=True):
        others = [
            other.recorded.name != relation.recorded.name and other.person == relation.person
            for other in every
        ]
        chosen = int(misfit[others].mean(axis=0).argmin()) if any(others) else SCALES.index(1.0)
        cells = " ".join(f"{value:.2f}" for value in row)
        yield f"{relation} | {cells} | {SCALES[chosen]} | {row[chosen]:.2f}"


Report = Callable[[Relation, int, int, int], Iterator[str]]
REPORTS: dict[str, Report] = {
    "models": report_models,
    "voters": report_voters,
    "confusion": report_confusion,
    "refused": report_refusals,
}


def main() -> None:
    """Print the reports asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("reports", nargs="+", choices=[*REPORTS, "scale"])
    parser.add_argument("--sets", nargs="+", help="names of sets; default: all")
    parser.add_argument("--pairs", type=int, default=150, help="pairs of takes per set")
    parser.add_argument("--variants", type=int, default=5, help="per pair")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    every = list(list_relations(given.data, given.sets))
    size = (given.pairs, given.variants, given.seed)
    for report in given.reports:
        if report == "scale":
            lines = scale(every, *size)
        else:
            lines = (line for each in every for line in REPORTS[report](each, *size))
        for line in lines:
            print(line, flush=True)


if __name__ == "__main__":
    main()
