"""Constants of the decision, each set's chosen without that set and the people in it.

`voters` prints every voter's mean distance to takes of the same gesture by others, and between
gestures. Then it changes one constant at a time and prints the share of takes whose nearest gesture
is right: for every set at the value that is best on the sets of other people, and at the
shipped one. `rejection` prints, for languages of half of a set's classes, the scores of right takes
by others, of takes of the other classes (near), and of movements of people who do not sign (far,
for whole bodies); how many of each the shipped limit rejects or accepts, and the one chosen without
the set.

    python -m benchmarks.accuracy.constants ../shared/data --subject voters
    python -m benchmarks.accuracy.constants ../shared/data --subject rejection
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Final
from unittest.mock import patch

import numpy as np
import numpy.typing as npt

from app.evaluation.share import Share
from app.recognition import Gesture, Language, PoseError, Recognizer
from app.recognition.decision import fusion
from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.outcome import LIMIT_OF_ARMS, LIMIT_OF_HANDS
from app.recognition.features import motion, traversals
from app.recognition.gestures.demonstration import condense
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.repair import repair_poses
from app.recognition.voters import motion_voters
from app.recognition.voters.motion_voters import Path, Place
from app.recognition.voters.registry import MOTION_VOTERS
from benchmarks.accuracy.people import recognize
from benchmarks.arguments import set_arguments
from benchmarks.sets.every_set import all_sets, is_of_bodies
from benchmarks.sets.one_shot_draws import Draw, demonstrated, draws
from benchmarks.sets.recorded_sets import DOMAINS, RecordedSet
from benchmarks.sets.simulated_bodies import CARRIED_DOMAINS
from benchmarks.sets.whole_body_sets import far_movements

TRIED: Final[Sequence[tuple[Any, str, tuple[float, ...]]]] = (
    (motion_voters, "SLOW", (0.1, 0.2, 0.3, 0.5, 1.0)),
    (Place, "prior", (0.5, 1.0, 1.5, 2.0)),
    (Place, "within", (0.5, 0.57, 0.64, 0.75)),
    (Path, "prior", (0.0, 0.25, 0.5, 1.0)),
    (motion, "RESTING_SHARE", (0.0, 0.02, 0.04, 0.07)),
    (traversals, "BACKWARD_PENALTY", (1.2, 1.4, 1.7, 2.0, 2.5)),
    (traversals, "EXCHANGED_PENALTY", (1.4, 1.5, 2.0, 3.0)),
    (fusion, "SAME_FIGURE", (0.25, 0.4, 0.5)),
)
"""Owner, name and tried values of the constants of the nearest gesture."""

SAME_PEOPLE: Final = (
    {*DOMAINS, *CARRIED_DOMAINS},
    {"utd_other", "utd_signals", "utd_figures"},
)
"""Sets of the same people's takes, which are left out together."""

LIMITS: Final = tuple(percent / 100 for percent in range(20, 101, 2))
"""Tried limits of the score."""

FAR_ACCEPTED: Final = 0.05
"""Largest share of far movements that a limit may accept on each set from which it is chosen."""


def others_or_own(chosen: Draw) -> npt.NDArray[np.intp]:
    """Return the queries by other people, or by anybody if the set does not name people."""
    return chosen.others if len(chosen.others) else chosen.own


def without_people_of(names: Sequence[str], name: str) -> list[str]:
    """Return the sets in which nobody occurs whose takes are in the named one."""
    left_out = next((group for group in SAME_PEOPLE if name in group), {name})
    return [other for other in names if other not in left_out]


@dataclass(frozen=True, eq=False)
class Asked:
    """A language of all classes, and queries.

    Attributes
    ----------
    gestures
        One of each class.
    queries
        Condensed takes.
    right
        The queries' labels.

    """

    gestures: list[Gesture]
    queries: list[Trajectory]
    right: list[str]

    def measure(self) -> tuple[FloatArray, FloatArray]:
        """Return the voters' distances.

        Returns
        -------
        ``(Q, V)`` to the right gestures, NaN where not comparable, and ``(V,)`` between gestures.

        """
        vote = FusedVote(self.gestures)
        labels = [gesture.label for gesture in self.gestures]
        within = [
            vote.compare(query).distances[:, labels.index(label)]
            for query, label in zip(self.queries, self.right, strict=True)
        ]
        known = np.where(np.isfinite(within), within, np.nan)
        return known, np.array([*vote.between.values()])

    def count_right(self) -> Share:
        """Count the queries whose nearest gesture is right, with all descriptors computed anew."""
        vote = FusedVote(
            [
                replace(each, trajectory=each.trajectory and replace(each.trajectory))
                for each in self.gestures
            ]
        )
        results = [vote.recognize(replace(query)) for query in self.queries]
        hits = [
            result is not None and result.nearest == label
            for result, label in zip(results, self.right, strict=True)
        ]
        return Share(sum(hits), len(hits))


def ask(recorded: RecordedSet, given: argparse.Namespace) -> Iterator[Asked]:
    """Yield randomly drawn languages of a set with their queries."""
    for chosen in draws(recorded, given.draws, given.queries, given.seed):
        queries, right = [], []
        for index in others_or_own(chosen):
            with suppress(PoseError):
                queries.append(condense(repair_poses(recorded.recordings[index]).trajectory))
                right.append(str(recorded.labels[index]))
        yield Asked(demonstrated(recorded, chosen.templates), queries, right)


def print_voters(data: Mapping[str, Sequence[Asked]]) -> None:
    """Print distances, and shares at every value of the constants and at those of other sets."""
    measured = {which: [each.measure() for each in languages] for which, languages in data.items()}
    for at, voter in enumerate(MOTION_VOTERS):
        cells, means = [], []
        for which, pairs in measured.items():
            own = np.concatenate([within[:, at] for within, _ in pairs])
            own = own[np.isfinite(own)]
            means += [float(own.mean())] if len(own) else []
            between = np.mean([between[at] for _, between in pairs])
            cells.append(f"{which} {own.mean() if len(own) else np.nan:.3f}/{between:.3f}")
        mean = np.mean(means) if means else np.nan
        print(f"{voter.name:10} {'  '.join(cells)} | mean {mean:.3f}, shipped {voter.within}")
    for owner, name, values in TRIED:
        shipped = getattr(owner, name)
        shares: dict[str, list[Share]] = {}
        for which, languages in data.items():
            shares[which] = []
            for value in values:
                with patch.object(owner, name, value):
                    counted = (language.count_right() for language in languages)
                    shares[which].append(sum(counted, Share(0, 0)))
        print(f"{owner.__name__.rsplit('.', 1)[-1]}.{name}, shipped {shipped}", flush=True)
        for which, row in shares.items():
            others = without_people_of([*data], which)
            nested = ""
            if others:
                best = int(_average([shares[each] for each in others]).argmax())
                nested = f"without it {values[best]}: {row[best]}, "
            print(
                f"  {which:16} {_list(values, _average([row]))} | {nested}shipped "
                f"{row[values.index(shipped)]}, n {row[0].asked}"
            )
        print(f"  {'mean':16} {_list(values, _average([*shares.values()]))}", flush=True)


def _average(rows: Sequence[Sequence[Share]]) -> FloatArray:
    """Return the mean share over the rows, for each column."""
    return np.asarray(np.mean([[share.value or 0.0 for share in row] for row in rows], axis=0))


def _list(values: Sequence[float], shares: FloatArray) -> str:
    return "  ".join(f"{value}: {share:.1%}" for value, share in zip(values, shares, strict=True))


@dataclass(frozen=True, eq=False)
class Decided:
    """Decisions about takes of others, for languages of half of the classes.

    Attributes
    ----------
    shipped
        The limit of usual languages of this kind, `LIMIT_OF_ARMS` or `LIMIT_OF_HANDS`.
    kind
        ``(Q,)``: ``right``, ``wrong``, ``near`` where the class is not in the language, or ``far``.
    novelty
        ``(Q,)`` of the nearest gesture.

    """

    shipped: float
    kind: npt.NDArray[np.str_]
    novelty: FloatArray

    def scores(self, kind: str) -> FloatArray:
        """Return the novelties of a kind times `shipped`: the scores in usual languages."""
        return np.asarray(self.novelty[self.kind == kind] * self.shipped)

    def accepted(self, kind: str, limit: float) -> Share:
        """Return the share of a kind within a limit."""
        scores = self.scores(kind)
        return Share(int((scores <= limit).sum()), len(scores))


def decide(recorded: RecordedSet, far: RecordedSet, given: argparse.Namespace) -> Decided:
    """Recognise takes of all classes, and far movements, with languages of half of the classes."""
    generator = np.random.default_rng(given.seed)
    found: list[tuple[str, float]] = []
    shipped = LIMIT_OF_HANDS
    for chosen in draws(recorded, given.draws, given.queries, given.seed):
        labels = {index: str(recorded.labels[index]) for index in chosen.templates}
        kept = set(generator.choice([*labels.values()], max(2, len(labels) // 2), replace=False))
        gestures = demonstrated(recorded, [each for each in labels if labels[each] in kept])
        shipped = LIMIT_OF_ARMS if FusedVote(gestures).references.sees_arms else LIMIT_OF_HANDS
        recognizer = Recognizer(Language(recorded.name, gestures), "full")
        asked = [*recognize(recognizer, recorded, others_or_own(chosen))]
        if is_of_bodies(recorded):
            order = generator.permutation(len(far.recordings))[: given.queries]
            asked += [(result, "") for result, _ in recognize(recognizer, far, order)]
        for result, label in asked:
            if result is None:
                continue
            kind = "right" if label == result.nearest else "wrong"
            if label not in kept:
                kind = "near" if label else "far"
            at = result.gestures.index(result.nearest)
            found.append((kind, float(result.novelty[at])))
    kinds, novelties = zip(*found, strict=True)
    return Decided(shipped, np.array(kinds), np.array(novelties))


def choose_limit(data: Sequence[Decided]) -> float:
    """Choose the largest limit that accepts at most `FAR_ACCEPTED` of each set's far movements.

    Where none has any, the limit with the fewest right takes rejected and near ones accepted.
    """
    if known := [scores for each in data if len(scores := each.scores("far"))]:
        return min(float(np.quantile(scores, FAR_ACCEPTED)) for scores in known)
    gain = _average([[each.accepted("right", at) for at in LIMITS] for each in data])
    loss = _average([[each.accepted("near", at) for at in LIMITS] for each in data])
    return LIMITS[int((gain - loss).argmax())]


def print_rejection(data: Mapping[str, Decided]) -> None:
    """Print scores, rejected and accepted shares, and what is chosen without each set."""
    for name, each in data.items():
        others = [data[other] for other in without_people_of([*data], name)]
        alike = [other for other in others if other.shipped == each.shipped]
        limits = {"shipped": each.shipped} | ({"without it": choose_limit(alike)} if alike else {})
        shown = [
            f"right {_quantiles(each.scores('right'), 90, 95)}",
            f"near {_quantiles(each.scores('near'), 5, 25)}",
            f"far {_quantiles(each.scores('far'), 5)}",
        ]
        for which, limit in limits.items():
            right = each.accepted("right", limit)
            rejected = Share(right.asked - right.correct, right.asked)
            shown.append(
                f"{which} {limit:.2f}: right rejected {rejected},"
                f" near accepted {each.accepted('near', limit)},"
                f" far accepted {each.accepted('far', limit)}"
            )
        counts = "/".join(str(int((each.kind == kind).sum())) for kind in ("right", "near", "far"))
        print(f"{name:16} n {counts}  " + "  ".join(shown), flush=True)
    for of_kind in (LIMIT_OF_ARMS, LIMIT_OF_HANDS):
        if alike := [each for each in data.values() if each.shipped == of_kind]:
            print(f"limit of all sets {choose_limit(alike):.2f}, shipped {of_kind}")


def _quantiles(scores: FloatArray, *percent: int) -> str:
    return (
        " ".join(f"{each:.2f}" for each in np.percentile(scores, percent)) if len(scores) else "-"
    )


def main() -> None:
    """Print the tables of one subject."""
    parser = set_arguments(__doc__, draws=10, queries=40)
    parser.add_argument("--subject", choices=("voters", "rejection"), default="voters")
    given = parser.parse_args()
    folder = given.data / "trajectories"
    sets = all_sets(folder, given.sets)
    if given.subject == "voters":
        print_voters({each.name: [*ask(each, given)] for each in sets})
    else:
        far = far_movements(folder)
        print_rejection({each.name: decide(each, far, given) for each in sets})


if __name__ == "__main__":
    main()
