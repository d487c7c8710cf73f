"""Constants of the voters and of rejection, each set's chosen without that set.

`voters` prints every voter's distances within and between classes, and compares three ways to weigh
the voters on a left-out set: the shipped priors, equal priors, and priors learned on the other sets
by logistic ranking. `rejection` prints, for languages of half of a set's classes, how many true
takes by others the shipped thresholds reject and how many out-of-vocabulary takes they accept.
Beside them stand the rates of an oracle, whose threshold is fitted to the set and rejects one in
twenty, and the confidence's coefficients fitted without the set.

    python -m benchmarks.accuracy.constants ../shared/data --subject voters
    python -m benchmarks.accuracy.constants ../shared/data --subject rejection
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition import Gesture, Language, PoseError, Recognizer
from app.recognition.decision.calibration import REACH
from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.rejection import SCORE_FLOOR
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.sequence import FloatArray
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.voters.registry import MOTION_VOTERS, VOTER_NAMES
from benchmarks.accuracy.people import all_sets
from benchmarks.arguments import set_arguments
from benchmarks.methods.ours import gesture_of
from benchmarks.sets.one_shot_draws import Draw, draws
from benchmarks.sets.recorded_sets import SETS, RecordedSet
from benchmarks.sets.simulated_bodies import CARRIED

CHOSEN_ON = (*SETS, "utd_other", "utkinect", *CARRIED)
"""The sets that the shipped constants were chosen on; the default."""

ROUNDS, STEP = 200, 0.3
"""Steps of the exponentiated gradient, and their length."""

NEWTON_ROUNDS = 30
"""Steps of Newton's method; logistic regression converges in about ten."""

ORACLE_REFUSES = 0.05
"""Share of true takes that the oracle's threshold rejects."""

KINDS = [VOTER_NAMES.index(voter.name) for voter in MOTION_VOTERS]
"""Rows of the motion voters among all."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """Queries of one language.

    Attributes
    ----------
    distances
        ``(Q, V, G)`` of the motion voters; infinite where not comparable.
    between
        ``(V,)``: the voters' between-class distances in this language.
    right
        ``(Q,)``: index of the right gesture.

    """

    distances: FloatArray
    between: FloatArray
    right: npt.NDArray[np.intp]


def others_or_own(chosen: Draw) -> npt.NDArray[np.intp]:
    """Return the queries by other people, or by anybody if the set does not name people."""
    return chosen.others if len(chosen.others) else chosen.own


def compare(recorded: RecordedSet, given: argparse.Namespace) -> Iterator[Comparison]:
    """Yield the distances of queries to the gestures of randomly drawn languages."""
    for chosen in draws(recorded, given.draws, given.queries, given.seed):
        labels = [str(recorded.labels[index]) for index in chosen.templates]
        vote = FusedVote(
            [
                gesture_of(label, recorded.recordings[index])
                for label, index in zip(labels, chosen.templates, strict=True)
            ]
        )
        queries = others_or_own(chosen)
        tables = [
            vote.compare(condense(repair_poses(recorded.recordings[index]).trajectory), drawn=False)
            for index in queries
        ]
        yield Comparison(
            distances=np.array([table.distances[KINDS] for table in tables]),
            between=np.array([vote.between[voter.name] for voter in MOTION_VOTERS]),
            right=np.array([labels.index(str(recorded.labels[index])) for index in queries]),
        )


def measure_within(compared: Sequence[Comparison]) -> FloatArray:
    """Return ``(V,)``: the median distance to the right gesture; NaN where not comparable."""
    own = np.concatenate(
        [each.distances[np.arange(len(each.right)), :, each.right] for each in compared]
    )
    return np.array(
        [np.median(row[row < np.inf]) if (row < np.inf).any() else np.nan for row in own.T]
    )


def average_over_sets(measured: Sequence[FloatArray]) -> FloatArray:
    """Return the geometric mean over the sets in which a voter compares: ``(V,)``."""
    logarithms = np.log(np.array(measured))
    known = np.isfinite(logarithms)
    total = np.where(known, logarithms, 0.0).sum(axis=0)
    count = known.sum(axis=0)
    means: FloatArray = np.full(len(total), np.nan)
    np.divide(total, count, out=means, where=count > 0)
    return np.asarray(np.exp(means))


def relate(each: Comparison, within: FloatArray) -> FloatArray:
    """Return ``(Q, V, G)``: distances over between-class distances, times the adapted weight."""
    with np.errstate(invalid="ignore"):
        adapted = np.maximum(0.0, 1.0 - within / each.between)
    scaled = each.distances * (np.nan_to_num(adapted) / each.between)[:, None]
    return np.where(np.isfinite(each.distances), scaled, 0.0)


def count_right(compared: Sequence[Comparison], within: FloatArray, priors: FloatArray) -> float:
    """Return the share of queries whose smallest weighted sum is the right gesture's."""
    hits = [
        (np.einsum("v,qvg->qg", priors, relate(each, within)).argmin(axis=1) == each.right)
        for each in compared
    ]
    return float(np.concatenate(hits).mean())


def learn_priors(sets: Sequence[Sequence[Comparison]], within: FloatArray) -> FloatArray:
    """Learn priors by logistic ranking of the right gesture; sets are weighted equally.

    Returns
    -------
    ``(V,)`` >= 0, by the exponentiated gradient (Kivinen and Warmuth 1997).

    """
    priors = np.ones(len(within))
    data = [
        (relate(each, within), each.right, len(sets) * sum(map(_size, one)))
        for one in sets
        for each in one
    ]
    for _ in range(ROUNDS):
        gradient = np.zeros_like(priors)
        for relative, right, count in data:
            scores = -np.einsum("v,qvg->qg", priors, relative)
            chance = np.exp(scores - scores.max(axis=1, keepdims=True))
            chance /= chance.sum(axis=1, keepdims=True)
            expected = np.einsum("qg,qvg->qv", chance, relative)
            gradient += (relative[np.arange(len(right)), :, right] - expected).sum(axis=0) / count
        priors = priors * np.exp(-STEP * gradient)
    return priors


def _size(each: Comparison) -> int:
    return len(each.right)


def print_voters(data: Mapping[str, Sequence[Comparison]]) -> None:
    """Print within- and between-class distances, and the nested comparison of priors."""
    within = {name: measure_within(each) for name, each in data.items()}
    for row, voter in enumerate(MOTION_VOTERS):
        print(
            f"{voter.name:14}",
            *(
                f"{name} {within[name][row]:.3f}/{np.mean([c.between[row] for c in each]):.3f}"
                for name, each in data.items()
            ),
            f"| shipped {voter.within}, over sets {average_over_sets([*within.values()])[row]:.3f}",
        )
    shipped = np.array([voter.prior for voter in MOTION_VOTERS])
    for name, each in data.items():
        others = [other for other in data if other != name]
        without = average_over_sets([within[other] for other in others])
        learned = learn_priors([data[other] for other in others], without)
        shares = {
            "shipped": count_right(each, without, shipped),
            "equal": count_right(each, without, np.ones(len(shipped))),
            "learned": count_right(each, without, learned),
        }
        print(
            f"{name:10}", *(f"{which} {share:.1%}" for which, share in shares.items()), flush=True
        )


@dataclass(frozen=True, eq=False)
class Decided:
    """Decisions about takes of others, for languages of half of the classes.

    Attributes
    ----------
    kind
        ``(Q,)``: ``right``, ``wrong``, or ``foreign`` where the class is not in the language.
    novelty, nearest, second
        ``(Q,)`` of the nearest gesture, and the two smallest scores.

    """

    kind: npt.NDArray[np.str_]
    novelty: FloatArray
    nearest: FloatArray
    second: FloatArray

    def regressors(self) -> FloatArray:
        """Return ``(Q, 3)``: 1, and the logarithms of novelty and of the share of the scores."""
        second = np.where(np.isfinite(self.second), self.second, 1.0) + SCORE_FLOOR
        share = np.log((self.nearest + SCORE_FLOOR) / second)
        return np.stack([np.ones_like(share), np.log(self.novelty + SCORE_FLOOR), share], axis=1)


def decide(recorded: RecordedSet, given: argparse.Namespace) -> Decided:
    """Recognise takes of all classes with languages of half of them."""
    generator = np.random.default_rng(given.seed)
    found: list[tuple[str, float, float, float]] = []
    for chosen in draws(recorded, given.draws, given.queries, given.seed):
        labels = {index: str(recorded.labels[index]) for index in chosen.templates}
        kept = set(generator.choice([*labels.values()], max(2, len(labels) // 2), replace=False))
        gestures: list[Gesture] = [
            gesture_of(label, recorded.recordings[index])
            for index, label in labels.items()
            if label in kept
        ]
        recognizer = Recognizer(Language(recorded.name, gestures), "full")
        for index in others_or_own(chosen):
            try:
                result = recognizer.recognize(recorded.recordings[index])
            except PoseError:
                continue
            label, at = str(recorded.labels[index]), result.gestures.index(result.nearest)
            kind = "right" if label == result.nearest else "wrong"
            nearest, second = np.sort(result.scores)[:2]
            found.append(
                (kind if label in kept else "foreign", float(result.novelty[at]), nearest, second)
            )
    kinds, novelties, nearest_scores, seconds = zip(*found, strict=True)
    return Decided(np.array(kinds), *map(np.array, (novelties, nearest_scores, seconds)))


def fit_confidence(data: Sequence[Decided]) -> FloatArray:
    """Fit the confidence's coefficients ``(3,)``; foreign takes weigh one half of each set."""
    regressors = np.concatenate([each.regressors() for each in data])
    right = np.concatenate([each.kind == "right" for each in data]).astype(float)
    weights = np.concatenate(
        [
            np.where(foreign, 0.5 / foreign.sum(), 0.5 / (~foreign).sum()) / len(data)
            for each in data
            for foreign in [each.kind == "foreign"]
        ]
    )
    coefficients = np.zeros(3)
    for _ in range(NEWTON_ROUNDS):
        chance = 1.0 / (1.0 + np.exp(-regressors @ coefficients))
        gradient = regressors.T @ (weights * (right - chance))
        curvature = (regressors.T * (weights * chance * (1 - chance))) @ regressors
        coefficients += np.linalg.solve(curvature, gradient)
    return coefficients


def print_rejection(data: Mapping[str, Decided]) -> None:
    """Print rejected and accepted shares, the oracle's, and the coefficients without each set."""
    reaches = []
    for name, each in data.items():
        right, foreign = (each.novelty[each.kind == kind] for kind in ("right", "foreign"))
        limit = float(np.quantile(right, 1 - ORACLE_REFUSES))
        reaches.append(limit * REACH)
        without = fit_confidence([other for which, other in data.items() if which != name])
        print(
            f"{name:10} n {len(right)}/{len(foreign)}  right refused {(right > 1).mean():.1%}  "
            f"foreign accepted {(foreign <= 1).mean():.1%}  oracle accepts "
            f"{(foreign <= limit).mean():.1%} at reach {limit * REACH:.1f}  "
            f"confidence {without.round(2).tolist()}",
            flush=True,
        )
    print(f"median reach {np.median(reaches):.1f}, shipped {REACH}")
    print(f"confidence of all sets {fit_confidence([*data.values()]).round(2).tolist()}")


def main() -> None:
    """Print the tables of one subject."""
    parser = set_arguments(__doc__, draws=10, queries=40)
    parser.add_argument("--subject", choices=("voters", "rejection"), default="voters")
    given = parser.parse_args()
    sets = list(all_sets(given.data / "trajectories", given.sets or CHOSEN_ON))
    if given.subject == "voters":
        print_voters({each.name: [*compare(each, given)] for each in sets})
    else:
        print_rejection({each.name: decide(each, given) for each in sets})


if __name__ == "__main__":
    main()
