"""Does the health report foresee which gestures get confused? Predicted against observed."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from app.recognition import Language, Recognizer
from app.recognition.errors import PoseError
from app.recognition.forecast import Forecast
from app.recognition.health_report import MOST_CONFUSION
from app.recognition.poses import FloatArray
from app.recognition.rehearsal import rehearse
from app.recognition.rejection import SCORE_FLOOR
from app.recognition.unforeseen import UNFORESEEN
from app.recognition.variation import Person
from benchmarks.recorded_sets import RecordedSet, recorded_sets
from benchmarks.shared_sets import demonstrated


@dataclass(frozen=True, eq=False)
class Pairs:
    """N ordered pairs of gestures, several languages' one after the other.

    Attributes
    ----------
    margins
        ``(N, variants)`` of the rehearsed takes of the first against the second.
    read
        ``(N,)`` real takes of the first that were nearest to the second.
    takes
        ``(N,)`` real takes of the first.
    nearness
        ``(N,)`` mean over the real takes of the logarithm of own over other score: how near they
        came to the second.

    """

    margins: FloatArray
    read: FloatArray
    takes: FloatArray
    nearness: FloatArray

    @classmethod
    def joined(cls, parts: Sequence[Pairs]) -> Pairs:
        """Put several languages together."""
        columns = zip(*(vars(part).values() for part in parts), strict=True)
        return cls(*(np.concatenate(column) for column in columns))


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
        Rehearsed takes of each gesture.
    seed
        Of what is drawn.

    """

    draws: int
    takes: int
    variants: int
    seed: int


def studied(recorded: RecordedSet, person: Person, study: Study) -> Pairs:
    """Teach takes of one person, rehearse, and let that person or the others perform."""
    generator = np.random.default_rng(study.seed)
    labels = np.unique(recorded.labels)
    parts = []
    for _ in range(study.draws):
        own = recorded.people == generator.choice(np.unique(recorded.people))
        templates = [
            int(generator.choice(np.flatnonzero(own & (recorded.labels == label))))
            for label in labels
        ]
        # Where people are not told apart, the others are among them.
        alone = own.all() or person == "same"
        pool = np.setdiff1d(np.flatnonzero(own if alone else ~own), templates)
        recognizer = Recognizer(Language(recorded.name, demonstrated(recorded, templates)))
        rehearsal = rehearse(recognizer, study.variants, person=person)
        for performer, label in enumerate(labels):
            mine = pool[recorded.labels[pool] == label]
            chosen = generator.choice(mine, min(study.takes, len(mine)), replace=False)
            scores = np.array(list(_scores(recognizer, recorded, chosen)))
            logarithms = np.log(np.minimum(scores, 1e9) + SCORE_FLOOR)
            near = np.bincount(scores.argmin(axis=1), minlength=len(labels))
            nearness = (logarithms[:, [performer]] - logarithms).mean(axis=0)
            others = np.delete(np.arange(len(labels)), performer)
            parts.append(
                Pairs(
                    rehearsal.margins[performer][:, others].T,
                    near[others].astype(np.float64),
                    np.full(len(others), float(len(scores))),
                    nearness[others],
                )
            )
    return Pairs.joined(parts)


def _scores(
    recognizer: Recognizer, recorded: RecordedSet, queries: npt.NDArray[np.intp]
) -> Iterator[FloatArray]:
    for query in queries:
        try:
            yield recognizer.compare(recognizer.query(recorded.recordings[query])).scores
        except PoseError:  # nothing moves
            continue


def report(name: str, pairs: Pairs, scale: float) -> str:
    """Say in a line how forecasts with this scale fit what was observed."""
    predicted = np.array([Forecast.of_margins(each, scale).rate for each in pairs.margins])
    confused, warned = pairs.read > 0, predicted > MOST_CONFUSION
    bounded = np.clip(predicted, 1e-6, 1 - 1e-6)
    likelihood = pairs.read * np.log(bounded) + (pairs.takes - pairs.read) * np.log(1 - bounded)
    return (
        f"{name:18} {scale:5.2f} {len(predicted):6} {_rank_correlation(predicted, pairs):6.2f} "
        f"{_discrimination(predicted, confused):6.2f} {predicted.mean():10.2%} "
        f"{pairs.read.sum() / pairs.takes.sum():9.2%} {warned.sum():7} "
        f"{(warned & confused).sum():9} {int(pairs.read[warned].sum()):5} of "
        f"{int(pairs.read.sum()):4} {likelihood.sum():9.0f}"
    )


def _rank_correlation(predicted: FloatArray, pairs: Pairs) -> float:
    """Spearman's, of predicted confusion and how near real takes came."""
    return float(np.corrcoef(_ranks(predicted), _ranks(pairs.nearness))[0, 1])


def _discrimination(predicted: FloatArray, confused: npt.NDArray[np.bool_]) -> float:
    """How probably a confused pair is predicted above one that never was (area under the ROC)."""
    count, rest = int(confused.sum()), int((~confused).sum())
    if not count or not rest:
        return float("nan")
    lowest = count * (count - 1) / 2
    return float((_ranks(predicted)[confused].sum() - lowest) / (count * rest))


def _ranks(values: FloatArray) -> FloatArray:
    """Rank ``(N,)`` values from 0, equal ones with their mean rank."""
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    return np.asarray((np.cumsum(counts) - (counts + 1) / 2)[inverse], dtype=np.float64)


def main() -> None:
    """Print one line a set, kind of performer and scale."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("data", type=Path, help="the folder that holds trajectories/")
    parser.add_argument("--sets", nargs="+", help="names of sets; default: all")
    parser.add_argument("--draws", type=int, default=10, help="languages per set")
    parser.add_argument("--takes", type=int, default=10, help="real takes of each gesture")
    parser.add_argument("--variants", type=int, default=16)
    parser.add_argument("--scales", type=float, nargs="*", default=[], help="further scales to try")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    study = Study(given.draws, given.takes, given.variants, given.seed)
    print(f"predicted against observed confusion of ordered pairs, seed {given.seed}")
    print(
        f"{'set':18} {'scale':>5} {'n':>6} {'rank':>6} {'AUC':>6} {'predicted':>10} "
        f"{'observed':>9} {'warned':>7} {'confused':>9} {'misread foreseen':>13} {'likelihood':>10}"
    )
    everything: dict[Person, list[Pairs]] = {"same": [], "another": []}
    for recorded in recorded_sets(given.data / "trajectories"):
        if given.sets and recorded.name not in given.sets:
            continue
        told_apart = len(np.unique(recorded.people)) > 1
        for person, found in everything.items():
            if person == "another" or told_apart:
                found.append(studied(recorded, person, study))
                name = f"{recorded.name} {person}"
                print(report(name, found[-1], UNFORESEEN[person]), flush=True)
    for person, found in everything.items():
        for scale in [UNFORESEEN[person], *given.scales] if found else []:
            print(report(f"all {person}", Pairs.joined(found), scale))


if __name__ == "__main__":
    main()
