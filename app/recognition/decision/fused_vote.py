"""Fused vote, the decision rule of profile ``full``: the smallest weighted sum of distances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from app.recognition.decision.confidence import estimate_confidence
from app.recognition.decision.fusion import fuse, weigh_distances, weigh_voters
from app.recognition.decision.hand_references import (
    HAND_LIMIT,
    HandReferences,
    score_hands,
    weigh_hands,
)
from app.recognition.decision.motion_references import (
    MAX_GESTURES_TRAVERSED,
    MotionReferences,
    NearestTraversals,
    describe_movement,
    find_tempo_dependent,
    find_unambiguous_traversals,
)
from app.recognition.decision.moving_shapes import WEIGHT, MovingShapes, weigh_shapes
from app.recognition.decision.references import References
from app.recognition.decision.rejection import (
    MOST_REFUSED,
    NOVELTIES,
    OthersScores,
    choose_limit,
    find_answer,
    is_rejected,
)
from app.recognition.decision.result import Recognition
from app.recognition.decision.score_table import ScoreTable
from app.recognition.decision.virtual_views import View, Views
from app.recognition.features.motion import SIZE
from app.recognition.features.trajectory_image import is_drawable
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.switches import Sensitivity
from app.recognition.gestures.tuning import AS_THE_PROFILE, Tuning
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.held_hands import find_least_movement, measure_movement
from app.recognition.voters.motion_voters import Tempo, Velocity
from app.recognition.voters.registry import HAND_VOTER_NAMES, MOTION_VOTERS, VOTER_NAMES

_TEMPO = VOTER_NAMES.index(Tempo.name)
_ALL_NAMES = (*VOTER_NAMES, *HAND_VOTER_NAMES)


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
        self._shown = References.of(gestures)
        sides, self._owners = self._shown.gestures, self._shown.owners
        self._motions = MotionReferences.of(sides)
        self._hands = HandReferences.of(sides, self._owners)
        self._moving_shapes = MovingShapes.of(sides, self._owners)
        self._least_movement = find_least_movement(
            gesture.trajectory
            for gesture in sides
            if gesture.trajectory is not None and not gesture.is_held and len(self._hands)
        )
        self._tempo = np.array([gesture.switches.tempo == "on" for gesture in sides])
        # Weight factors must not change which directions and tempos the language needs.
        self._weights, self._between = self._weigh()
        self._others = self._calibrate(sides)
        self._limit = self._choose_limit(refused)
        factors = tuning.weights_of(VOTER_NAMES)
        weighed: FloatArray = self._weights * factors
        # Voters that have no weight in this language decide where the author leaves no others.
        self._weights = weighed if weighed.any() or not tuning.weights else factors
        self._views = Views(sides, self._motions)

    def _weigh(self) -> tuple[FloatArray, FloatArray]:
        """Return the voters' weights in the language, and their between-class distances."""
        first_rows = self._motions.as_shown[:MAX_GESTURES_TRAVERSED]
        one, other = np.triu_indices(len(first_rows), 1)
        owners = self._owners[self._motions.gestures[first_rows]]
        apart = owners[one] != owners[other]
        pairs = self._motions.own_distances[:, :, first_rows][:, one[apart], other[apart]]
        known = [row[np.isfinite(row)] for row in pairs]
        return weigh_voters(MOTION_VOTERS, known, arms=self._motions.sees_arms)

    def _calibrate(self, sides: Sequence[Gesture]) -> OthersScores:
        """Find which directions and tempos the language needs, and return what sets its limit."""
        scores = fuse(self._motions.own_distances, self._weights, self._between)
        scores *= self._motions.own_corrections
        kept = np.arange(len(self._motions))
        if len(self._motions.as_shown) <= MAX_GESTURES_TRAVERSED:
            self._tempo = find_tempo_dependent(self._motions, scores, sides, self._owners)
            self._moving_shapes = self._moving_shapes.with_twins(sides, self._spread(scores))
            free = [
                owner
                for owner, gesture in zip(self._owners, sides, strict=True)
                if gesture.switches.direction == "off"
            ]
            kept = find_unambiguous_traversals(self._motions, scores, self._owners, free)
            self._motions = self._motions.take(kept)
        return self._measure_others(scores[:, kept] * self._motions.penalties, sides)

    def _choose_limit(self, refused: float) -> float:
        """Return the limit at a share of right takes that may be rejected."""
        alike = max(1.0, Velocity.between / float(self._between[VOTER_NAMES.index(Velocity.name)]))
        return choose_limit(self._others, refused, arms=self._motions.sees_arms, alike=alike)

    def _spread(self, scores: FloatArray) -> FloatArray:
        """Return the scores of the references' movements as shown, ``(S, S)``; infinite if none."""
        rows = self._motions.as_shown
        spread = np.full((len(self._owners), len(self._owners)), np.inf)
        members = self._motions.gestures[rows]
        spread[np.ix_(members, members)] = scores[:, rows]
        return spread

    def _measure_others(self, scores: FloatArray, sides: Sequence[Gesture]) -> OthersScores:
        """Return the scores of demonstrations among those of other people.

        Parameters
        ----------
        scores
            ``(S, R)`` of the demonstrated traversals, with penalties, for all rows.
        sides
            The references. Those whose diver is not named count as by one person.

        """
        rows = self._motions.as_shown[: len(scores)]
        # A mirror image stands for its demonstration, and is no take by itself.
        taken = np.flatnonzero(~self._shown.mirrored[self._motions.gestures[rows]])
        every, sizes = np.arange(len(self._motions)), self._motions.descriptors[SIZE]
        scores = scores * self._motions.measure_smallness(sizes[rows][:, None], every)
        divers = np.array([each.diver for each in sides], dtype=np.str_)[self._motions.gestures]
        owners = self._owners[self._motions.gestures]
        return OthersScores.of(scores[taken], rows[taken], owners, divers)

    def sensitivity(self, gesture: int) -> Sensitivity | None:
        """Return which properties of a gesture count; None for a gesture without movement."""
        rows = np.flatnonzero(self._motions.gestures == gesture)
        if not len(rows):
            return None
        traversals = [self._motions.traversals[row] for row in rows]
        return Sensitivity(
            direction=not any(traversal.backward for traversal in traversals),
            tempo=bool(self._tempo[gesture]),
            sides=not any(traversal.exchanged for traversal in traversals),
            hand_shape=bool(self._moving_shapes.counting[self._owners == gesture].any()),
        )

    @property
    def shape_twins(self) -> frozenset[tuple[int, int]]:
        """Pairs of gestures, the first index the smaller, that the hand shape alone tells apart."""
        return self._moving_shapes.twins

    @property
    def landmarks(self) -> tuple[str, ...]:
        """The salient landmarks of all gestures, in alphabetical order."""
        return self._motions.landmarks

    @property
    def needed(self) -> tuple[str, ...]:
        """The landmarks that any gesture needs, in alphabetical order."""
        return tuple(sorted({name for salient in self._salient for name in salient}))

    @cached_property
    def _salient(self) -> dict[tuple[str, ...], npt.NDArray[np.intp]]:
        """The references with a movement, by their salient landmarks."""
        found: dict[tuple[str, ...], list[int]] = {}
        for index in np.unique(self._motions.gestures).tolist():
            found.setdefault(self._shown.gestures[index].salient, []).append(index)
        return {salient: np.array(rows, dtype=np.intp) for salient, rows in found.items()}

    @cached_property
    def weights(self) -> Mapping[str, float]:
        """Each voter's weight in the decision, summing to 1."""
        weights = self._weights.copy()
        if self._tempo.any():
            weights[_TEMPO] += Tempo.weight_where_needed
        names = VOTER_NAMES
        if self._moving_shapes.any_counts:
            names = _ALL_NAMES
            weights = np.append(weights, [WEIGHT / len(HAND_VOTER_NAMES)] * len(HAND_VOTER_NAMES))
        normalized = (weights / weights.sum()).tolist()
        return MappingProxyType(dict(zip(names, normalized, strict=True)))

    @property
    def between(self) -> dict[str, float]:
        """Each voter's between-class distance in this language."""
        return dict(zip(VOTER_NAMES, self._between.tolist(), strict=True))

    @property
    def limit(self) -> float:
        """The score beyond which a movement is rejected (`rejection`)."""
        return self._limit

    @property
    def others(self) -> OthersScores:
        """The demonstrations' scores among those of other people, before weight factors."""
        return self._others

    @property
    def references(self) -> MotionReferences:
        """The gestures' movements in all traversals that are not ambiguous in the language."""
        return self._motions

    def compare(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a condensed query with the nearest demonstration of every gesture.

        Mirror images count as demonstrations. Demonstrations with depth are turned to face as the
        diver of the query does (`views`); where that is not known, to the view in which one of them
        is nearest.

        A query that holds one hand shape is compared with the held shapes, a query that holds two
        in sequence with the sequences, and any other query with the movements. A query that holds a
        shape and moves about as little as the smallest movement is compared with both: it is the
        movement if it is accepted as one, otherwise the alternative of lower novelty.
        """
        if not len(self._hands):
            return self._compare_movements(trajectory)
        held = self._compare_hands(trajectory) if trajectory.hands else None
        if held is not None and measure_movement(trajectory) < self._least_movement:
            return held
        moved = self._compare_movements(trajectory)
        if not self._moving_shapes.any_counts:
            moved = moved.with_idle_voters(HAND_VOTER_NAMES)
        if held is None or not is_rejected(_measure_novelty(moved)):
            return moved
        return min(held, moved, key=_measure_novelty)

    def _compare_movements(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a movement with those of the language."""
        views = self._views.list_for(trajectory.facing)
        comparable = self._find_comparable(trajectory)
        tables = [self._compare_in(view, trajectory, comparable) for view in views]
        return min(tables, key=lambda table: float(table.scores.min()))

    def _compare_hands(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a held hand shape with those of the language."""
        sides = self._hands.distances(trajectory.held_shapes)
        shares = weigh_hands(sides)
        chosen = self._shown.find_nearest(shares.sum(axis=0))
        distances = np.full((len(_ALL_NAMES), len(chosen)), np.inf)
        contributions = np.zeros(distances.shape)
        distances[len(VOTER_NAMES) :] = sides.take(chosen, axis=1)
        contributions[len(VOTER_NAMES) :] = shares.take(chosen, axis=1)
        novelty = np.full((len(NOVELTIES), len(chosen)), np.nan)
        novelty[-1] = self._hand_novelty(sides)[chosen]
        return ScoreTable(
            voters=_ALL_NAMES,
            distances=distances,
            contributions=contributions,
            turned=np.zeros(len(chosen)),
            traversals=(None,) * len(chosen),
            mirrored=np.zeros(len(chosen), dtype=bool),
            demonstrations=self._shown.demonstrations[chosen],
            views=np.zeros(len(chosen), dtype=np.intp),
            facing=trajectory.facing,
            novelty_by_view=novelty,
        )

    def _compare_in(
        self, view: View, trajectory: Trajectory, comparable: npt.NDArray[np.bool_]
    ) -> ScoreTable:
        nearest = self._compare_sides(view, trajectory, comparable)
        distances, rows = nearest.distances, nearest.rows
        shares = nearest.corrections * weigh_distances(distances, self._weights, self._between)
        factors, scores = np.ones(len(rows)), shares.sum(axis=0)
        moved = rows >= 0
        factors[moved] = self._motions.penalties[rows[moved]]
        turned = np.zeros(len(rows))
        backward = factors > 1
        turned[backward] = (factors[backward] - 1) * scores[backward]
        if self._tempo.any():
            slower = self._tempo & np.isfinite(distances[_TEMPO])
            shares[_TEMPO, slower] += Tempo.weight_where_needed * distances[_TEMPO, slower]
            scores = shares.sum(axis=0)
        voters, compared = VOTER_NAMES, scores + turned
        novelty = np.full((len(NOVELTIES), len(rows)), np.nan)
        novelty[0] = compared / self._limit
        if moved.any():
            size = describe_movement(trajectory, self._motions.landmarks)[SIZE]
            novelty[0, moved] *= self._motions.measure_smallness(size, rows[moved])
        if self._moving_shapes.any_counts:
            voters = _ALL_NAMES
            hands = self._compare_moving_hands(trajectory, rows, compared)
            distances = np.concatenate([distances, hands])
            shares = np.concatenate([shares, weigh_shapes(hands)])
            compared = shares.sum(axis=0) + turned
            novelty[-1] = self._hand_novelty(hands)
        chosen = self._shown.find_nearest(compared)
        return ScoreTable(
            voters=voters,
            distances=distances.take(chosen, axis=1),
            contributions=shares.take(chosen, axis=1),
            turned=turned[chosen],
            traversals=tuple(
                self._motions.traversals[row] if row >= 0 else None for row in rows[chosen].tolist()
            ),
            mirrored=self._shown.mirrored[chosen],
            demonstrations=self._shown.demonstrations[chosen],
            views=view.turns[chosen],
            facing=trajectory.facing,
            novelty_by_view=novelty.take(chosen, axis=1),
        )

    def _compare_moving_hands(
        self, trajectory: Trajectory, rows: npt.NDArray[np.intp], scores: FloatArray
    ) -> FloatArray:
        """Return the hand voters' distances ``(2, sides)`` of a movement.

        Parameters
        ----------
        trajectory
            The query.
        rows, scores
            ``(sides,)``: the nearest traversals, -1: none, and their scores; infinite scores where
            a movement is not comparable.

        """
        traversals = self._motions.traversals
        exchanged = [row >= 0 and traversals[row].exchanged for row in rows.tolist()]
        found = self._moving_shapes.distances(
            trajectory.moving_hands, np.array(exchanged, dtype=bool)
        )
        found[:, ~np.isfinite(scores)] = np.inf
        return found

    def _hand_novelty(self, distances: FloatArray) -> FloatArray:
        """Return the novelties ``(sides,)`` of hand voters' distances; NaN where not comparable."""
        score = score_hands(distances)
        return np.where(np.isfinite(score), score / HAND_LIMIT, np.nan)

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
        answer = [self._labels[index] for index in find_answer(scores, novelty)]
        return Recognition(
            label=answer[0] if len(answer) == 1 else None,
            pair=(answer[0], answer[1]) if len(answer) == 2 else None,
            nearest=self._labels[winner],
            confidence=estimate_confidence(
                float(novelty[winner]),
                float(scores[winner]),
                float(np.sort(scores)[1]) if len(scores) > 1 else np.inf,
            ),
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
        if not len(self._hands):
            return self.weights
        by_hand = not np.isfinite(compared.distances[: len(VOTER_NAMES)]).any()
        if by_hand:
            of_hand = dict.fromkeys(HAND_VOTER_NAMES, 1 / len(HAND_VOTER_NAMES))
            return MappingProxyType(dict.fromkeys(VOTER_NAMES, 0.0) | of_hand)
        return MappingProxyType(dict.fromkeys(HAND_VOTER_NAMES, 0.0) | {**self.weights})

    def _compare_sides(
        self, view: View, trajectory: Trajectory, comparable: npt.NDArray[np.bool_]
    ) -> NearestTraversals:
        """Return the nearest traversal of every reference; infinite where not comparable."""
        count = len(self._owners)
        if not comparable.any():
            distances = np.full((len(VOTER_NAMES), count), np.inf)
            return NearestTraversals(np.full(count, -1), distances, np.ones(count))
        query = describe_movement(trajectory, self._motions.landmarks)
        nearest = view.motions.find_nearest(query, self._weights, self._between, count)
        nearest.distances[:, ~comparable] = np.inf
        return nearest

    def _find_comparable(self, trajectory: Trajectory) -> npt.NDArray[np.bool_]:
        """Return ``(S,)``: the references whose salient landmarks a query shows and moves."""
        comparable = np.zeros(len(self._owners), dtype=bool)
        for salient, members in self._salient.items():
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
