"""Fused vote, the decision rule of profile ``full``: the smallest weighted sum of distances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from app.recognition.decision.fusion import (
    OPINION_EXPONENT,
    add_second_opinion,
    find_tempo_dependent,
    find_unambiguous_traversals,
    fuse,
    list_views,
    weigh_distances,
    weigh_voters,
)
from app.recognition.decision.hand_references import (
    WEIGHT,
    HeldReferences,
    MovingReferences,
    measure_hand_novelty,
    weigh_hands,
    weigh_moving_hands,
)
from app.recognition.decision.outcome import (
    MOST_REFUSED,
    NOVELTIES,
    OthersScores,
    bound_confidence,
    choose_limit,
    estimate_confidence,
    find_answer,
    is_rejected,
)
from app.recognition.decision.references import (
    MOST_DEMONSTRATIONS_TRAVERSED,
    References,
    describe_query,
    find_nearest,
)
from app.recognition.decision.result import Recognition, ScoreTable
from app.recognition.features.motion import SHARES, SIZE
from app.recognition.features.trajectory_image import is_drawable
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.profile import AS_THE_PROFILE, Tuning
from app.recognition.gestures.switches import Sensitivity
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.holds import find_least_movement, measure_movement
from app.recognition.voters.motion_voters import Path, SecondOpinion, Tempo, Velocity
from app.recognition.voters.registry import HAND_VOTER_NAMES, MOTION_VOTERS, VOTER_NAMES

_TEMPO, _OPINION = (VOTER_NAMES.index(voter.name) for voter in (Tempo, SecondOpinion))
_ALL_NAMES = (*VOTER_NAMES, *HAND_VOTER_NAMES)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Candidates:
    """The references that a query is compared with, M of them, and how near they are.

    Attributes
    ----------
    voters, distances, contributions, turned
        As in `ScoreTable`, for M references.
    novelty
        ``(2, M)``: by each of `NOVELTIES`.
    shown
        ``(M,)``: index of each one's demonstration.
    rows
        ``(M,)``: row of each movement; None for held hands.

    """

    voters: tuple[str, ...]
    distances: FloatArray
    contributions: FloatArray
    turned: FloatArray
    novelty: FloatArray
    shown: npt.NDArray[np.intp]
    rows: npt.NDArray[np.intp] | None = None

    @classmethod
    def none(cls, voters: tuple[str, ...]) -> _Candidates:
        """Return no candidates."""
        nothing = np.zeros((len(voters), 0))
        return cls(
            voters=voters,
            distances=nothing,
            contributions=nothing,
            turned=np.zeros(0),
            novelty=np.zeros((len(NOVELTIES), 0)),
            shown=np.zeros(0, dtype=np.intp),
            rows=np.zeros(0, dtype=np.intp),
        )

    @property
    def scores(self) -> FloatArray:
        """``(M,)``: the fused distances."""
        return np.asarray(self.contributions.sum(axis=0) + self.turned)


class FusedVote:
    """Fuses the distances of all voters, weighted by how well each separates the gestures.

    Parameters
    ----------
    gestures
        G gestures, at least one.
    tuning
        Its weight factors multiply the voters' weights in this language.
    refused
        Share of right takes that may be rejected, where several people have shown the gestures.

    Raises
    ------
    OsgError
        When the weights do not fit the voters.

    """

    def __init__(
        self,
        gestures: Sequence[Gesture],
        tuning: Tuning = AS_THE_PROFILE,
        refused: float = MOST_REFUSED,
    ) -> None:
        self._labels = tuple(gesture.label for gesture in gestures)
        every = References.of(gestures)
        self._held = HeldReferences.of(every.shown, every.owners)
        self._least_movement = find_least_movement(
            each.trajectory
            for each in every.shown
            if each.trajectory is not None and not each.is_held and len(self._held)
        )
        # Weight factors must not change which directions and tempos the language needs.
        weights, self._between = _weigh_voters(every)
        scores = fuse(every.own_distances, weights, self._between) * every.own_corrections
        # Among more gestures nothing is found automatically.
        compared = scores if len(every.as_shown) <= MOST_DEMONSTRATIONS_TRAVERSED else scores[:0]
        self._tempo = find_tempo_dependent(every, compared)
        self._moving = MovingReferences.of(every.shown, every.owners, _spread(every, compared))
        kept = find_unambiguous_traversals(every, compared)
        self.references = every.take(kept)
        penalized = scores[:, kept] * self.references.penalties
        self.others = _measure_others(self.references, penalized)
        alike = max(1.0, Velocity.between / self.between[Velocity.name])
        self.limit = choose_limit(self.others, refused, arms=every.sees_arms, alike=alike)
        factors = tuning.weights_of(VOTER_NAMES)
        self._weights: FloatArray = weights * factors
        # Voters that have no weight in this language decide where the author leaves no others.
        if tuning.weights and not self._weights.any():
            self._weights = factors
        known = np.isfinite(self.references.described[SecondOpinion.name]).all()
        opinion = factors[_OPINION] * weights.sum() / max(self._weights.sum(), 1e-9)
        self._opinion = float(opinion) if known and not self._moving.any_counts else 0.0

    def sensitivity(self, gesture: int) -> Sensitivity | None:
        """Return which properties of a gesture count; None for a gesture without movement."""
        references = self.references
        traversals = [
            references.traversals[row] for row in np.flatnonzero(references.rows == gesture)
        ]
        if not traversals:
            return None
        return Sensitivity(
            direction=not any(traversal.backward for traversal in traversals),
            tempo=bool(self._tempo[gesture]),
            sides=not any(traversal.exchanged for traversal in traversals),
            hand_shape=bool(self._moving.counting[references.owners == gesture].any()),
        )

    @property
    def shape_twins(self) -> frozenset[tuple[int, int]]:
        """Pairs of gestures, the first index the smaller, that the hand shape alone tells apart."""
        return self._moving.twins

    @property
    def undecided_twins(self) -> frozenset[tuple[int, int]]:
        """Pairs that it would tell apart, if the author said that their hands are meant."""
        return self._moving.undecided

    @property
    def landmarks(self) -> tuple[str, ...]:
        """The salient landmarks of all gestures, in alphabetical order."""
        return self.references.landmarks

    @property
    def needed(self) -> tuple[str, ...]:
        """The landmarks that any gesture needs, in alphabetical order."""
        return tuple(sorted({name for salient in self.references.salient for name in salient}))

    @cached_property
    def weights(self) -> Mapping[str, float]:
        """Each voter's weight in the decision, summing to 1."""
        weights = self._weights.copy()
        weights[_OPINION] += OPINION_EXPONENT * self._opinion * weights.sum()
        if self._tempo.any():
            weights[_TEMPO] += Tempo.weight_where_needed
        names = VOTER_NAMES
        if self._moving.any_counts:
            names = _ALL_NAMES
            weights = np.append(weights, [WEIGHT / len(HAND_VOTER_NAMES)] * len(HAND_VOTER_NAMES))
        normalized = (weights / weights.sum()).tolist()
        return MappingProxyType(dict(zip(names, normalized, strict=True)))

    @property
    def between(self) -> dict[str, float]:
        """Each voter's between-class distance in this language."""
        return dict(zip(VOTER_NAMES, self._between.tolist(), strict=True))

    def compare(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a condensed query with the nearest demonstration of every gesture.

        Mirror images count as demonstrations. Demonstrations with depth are turned to face as the
        diver of the query does (`list_views`); where that is not known, to the view in which one of
        them is nearest.

        A query that holds one hand shape is compared with the held shapes, a query that holds two
        in sequence with the sequences, and any other query with the movements. A query that holds a
        shape and moves about as little as the smallest movement is compared with both: it is the
        movement if it is accepted as one, otherwise the alternative of lower novelty.
        """
        if not len(self._held):
            return self._compare_movements(trajectory)
        held = self._compare_hands(trajectory) if trajectory.hands else None
        if held is not None and measure_movement(trajectory) < self._least_movement:
            return held
        moved = self._compare_movements(trajectory)
        if not self._moving.any_counts:
            moved = moved.with_idle_voters(HAND_VOTER_NAMES)
        if held is None or not is_rejected(_measure_novelty(moved)):
            return moved
        return min(held, moved, key=_measure_novelty)

    def _compare_movements(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a movement with those of the language."""
        comparable = self._find_comparable(trajectory)
        tables = [
            self._tabulate(self._compare_in(view, trajectory, comparable), view, trajectory.facing)
            for view in list_views(self.references, trajectory.facing)
        ]
        return add_second_opinion(
            min(tables, key=lambda table: float(table.scores.min())), self._opinion
        )

    def _compare_hands(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a held hand shape with those of the language."""
        found = self._held.distances(trajectory.held_shapes)
        nothing = np.full((len(VOTER_NAMES), len(self._held)), np.inf)
        held = _Candidates(
            voters=_ALL_NAMES,
            distances=np.concatenate([nothing, found]),
            contributions=np.concatenate([np.zeros(nothing.shape), weigh_hands(found)]),
            turned=np.zeros(len(self._held)),
            novelty=np.array([np.full(len(self._held), np.nan), measure_hand_novelty(found)]),
            shown=self._held.members,
        )
        return self._tabulate(held, self.references, trajectory.facing)

    def _compare_in(
        self, references: References, trajectory: Trajectory, comparable: npt.NDArray[np.bool_]
    ) -> _Candidates:
        """Compare a movement with the references in one view."""
        voters = _ALL_NAMES if self._moving.any_counts else VOTER_NAMES
        if not comparable.any():
            return _Candidates.none(voters)
        query = describe_query(trajectory, references.landmarks)
        rows = references.find_promising(query[Path.name])
        rows = rows[comparable[references.rows[rows]]]
        distances, shown = references.measure(query, rows), references.rows[rows]
        weighed = weigh_distances(distances, self._weights, self._between)
        correction, penalties = references.correct(query[SHARES], rows), references.penalties[rows]
        shares = correction * weighed
        scores = shares.sum(axis=0)
        distances[_OPINION] *= correction * penalties / self._between[_OPINION]
        turned = np.where(penalties > 1, (penalties - 1) * scores, 0.0)
        slower = self._tempo[shown] & np.isfinite(distances[_TEMPO])
        shares[_TEMPO, slower] += Tempo.weight_where_needed * distances[_TEMPO, slower]
        smallness = references.measure_smallness(query[SIZE], rows)
        novelty = np.full((len(NOVELTIES), len(rows)), np.nan)
        novelty[0] = (shares.sum(axis=0) + turned) / self.limit * smallness
        if self._moving.any_counts:
            hands = self._compare_moving_hands(trajectory, references, rows)
            hands[:, ~np.isfinite(scores)] = np.inf
            distances = np.concatenate([distances, hands])
            shares = np.concatenate([shares, weigh_moving_hands(hands)])
            novelty[-1] = measure_hand_novelty(hands)
        return _Candidates(
            voters=voters,
            distances=distances,
            contributions=shares,
            turned=turned,
            novelty=novelty,
            shown=shown,
            rows=rows,
        )

    def _compare_moving_hands(
        self, trajectory: Trajectory, references: References, rows: npt.NDArray[np.intp]
    ) -> FloatArray:
        """Return the hand voters' distances ``(3, M)`` of a movement to M rows."""
        hands, shown = trajectory.moving_hands, references.rows[rows]
        found = self._moving.distances(hands, exchanged=False)[:, shown]
        exchanged = np.array([references.traversals[row].exchanged for row in rows.tolist()])
        if exchanged.any():
            other = self._moving.distances(hands, exchanged=True)[:, shown]
            found = np.where(exchanged, other, found)
        return found

    def _tabulate(
        self, found: _Candidates, references: References, facing: float | None
    ) -> ScoreTable:
        """Return the score table of each gesture's nearest candidate."""
        owners = references.owners[found.shown]
        nearest = find_nearest(found.scores, owners, len(self._labels))
        known = nearest >= 0
        chosen = nearest[known]
        shown = np.zeros(len(nearest), dtype=np.intp)
        shown[known] = found.shown[chosen]

        def spread(values: FloatArray, missing: float) -> FloatArray:
            whole = np.full((*values.shape[:-1], len(nearest)), missing)
            whole[..., known] = values[..., chosen]
            return whole

        novelty = spread(found.novelty, np.nan)
        rows = np.full(len(nearest), -1)
        if found.rows is not None:
            rows[known] = found.rows[chosen]
            novelty[0, ~known] = np.inf
        return ScoreTable(
            voters=found.voters,
            distances=spread(found.distances, np.inf),
            contributions=spread(found.contributions, np.inf),
            turned=spread(found.turned, 0.0),
            traversals=tuple(
                references.traversals[row] if row >= 0 else None for row in rows.tolist()
            ),
            mirrored=known & references.mirrored[shown],
            demonstrations=np.where(known, references.demonstrations[shown], 0),
            views=np.where(known, references.turns[shown], 0),
            facing=facing,
            novelty_by_view=novelty,
        )

    def recognize(self, trajectory: Trajectory) -> Recognition | None:
        """Recognise a condensed query; None if no landmark that a gesture needs moves."""
        compared = self.compare(trajectory)
        return self.decide(compared) if np.isfinite(compared.scores).any() else None

    def decide(self, compared: ScoreTable) -> Recognition:
        """Return the gesture with the smallest score, a pair or a rejection; see `find_answer`.

        One of the scores must be finite.
        """
        distances, scores, novelty = compared.distances, compared.scores, compared.novelty
        winner = int(scores.argmin())
        able = np.flatnonzero(np.isfinite(distances).any(axis=1)).tolist()
        nearest_by_voter = distances.argmin(axis=1)
        opinion = int(nearest_by_voter[_OPINION]) if _OPINION in able else None
        found = find_answer(scores, novelty, opinion)
        answer = [self._labels[index] for index in found]
        second = float(np.sort(scores)[1]) if len(scores) > 1 else np.inf
        novel = float(novelty[winner])
        confidence = estimate_confidence(novel, float(scores[winner]), second)
        return Recognition(
            label=answer[0] if len(answer) == 1 else None,
            pair=(answer[0], answer[1]) if len(answer) == 2 else None,
            nearest=self._labels[winner],
            confidence=bound_confidence(confidence, len(answer), novel),
            profile="full",
            voters=compared.voters,
            gestures=self._labels,
            distances=distances,
            votes={compared.voters[row]: self._labels[nearest_by_voter[row]] for row in able},
            weights=self._weights_in(compared),
            scores=scores,
            novelty=novelty,
            novelty_by_view=dict(zip(NOVELTIES, compared.novelty_by_view, strict=True)),
            facing=compared.facing,
            views=compared.views.astype(np.float64),
        )

    def _weights_in(self, compared: ScoreTable) -> Mapping[str, float]:
        """Return the voters' weights in a decision: of the movement, or of the held hands."""
        if not len(self._held):
            return self.weights
        by_hand = not np.isfinite(compared.distances[: len(VOTER_NAMES)]).any()
        if by_hand:
            of_hand = dict.fromkeys(HAND_VOTER_NAMES, 1 / len(HAND_VOTER_NAMES))
            return MappingProxyType(dict.fromkeys(VOTER_NAMES, 0.0) | of_hand)
        return MappingProxyType(dict.fromkeys(HAND_VOTER_NAMES, 0.0) | {**self.weights})

    def _find_comparable(self, trajectory: Trajectory) -> npt.NDArray[np.bool_]:
        """Return ``(S,)``: the references whose salient landmarks a query shows and moves."""
        comparable = np.zeros(len(self.references.shown), dtype=bool)
        for salient, members in self.references.salient.items():
            if len(trajectory) > 1 and set(salient) <= set(trajectory.landmarks):
                seen = trajectory.select(salient)
                shown = np.isfinite(seen.xy).all(axis=2).any(axis=0).all()
                comparable[members] = bool(shown) and is_drawable(seen)
        return comparable


def _measure_novelty(table: ScoreTable) -> float:
    """Return the novelty of a query for its nearest gesture; infinite if none is comparable."""
    if not np.isfinite(table.scores).any():
        return np.inf
    return float(np.nan_to_num(table.novelty[table.scores.argmin()], posinf=np.inf))


def _weigh_voters(references: References) -> tuple[FloatArray, FloatArray]:
    """Return the voters' weights in a language, and their between-class distances."""
    rows = references.as_shown[:MOST_DEMONSTRATIONS_TRAVERSED]
    one, other = np.triu_indices(len(rows), 1)
    owners = references.row_owners[rows]
    apart = owners[one] != owners[other]
    pairs = references.own_distances[:, :, rows][:, one[apart], other[apart]]
    known = [row[np.isfinite(row)] for row in pairs]
    return weigh_voters(MOTION_VOTERS, known, arms=references.sees_arms)


def _spread(references: References, scores: FloatArray) -> FloatArray:
    """Return the scores of the movements as shown, ``(S, S)``; infinite where there is none."""
    members = references.rows[references.as_shown]
    spread = np.full((len(references.shown), len(references.shown)), np.inf)
    spread[np.ix_(members[: len(scores)], members)] = scores[:, references.as_shown]
    return spread


def _measure_others(references: References, scores: FloatArray) -> OthersScores:
    """Return the scores of demonstrations among those of other people.

    Those whose diver is not named count as by one person.

    Parameters
    ----------
    references
        In the traversals that are kept.
    scores
        ``(S', R)`` of the demonstrated traversals for all rows, with penalties.

    """
    rows = references.as_shown[: len(scores)]
    # A mirror image stands for its demonstration, and is no take by itself.
    taken = np.flatnonzero(~references.mirrored[references.rows[rows]])
    scores = scores * references.measure_smallness(references.described[SIZE][rows][:, None])
    divers = np.array([each.diver for each in references.shown], dtype=np.str_)[references.rows]
    return OthersScores.of(scores[taken], rows[taken], references.row_owners, divers)
