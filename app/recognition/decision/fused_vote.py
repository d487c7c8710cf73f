"""Fused vote, the decision rule of profile ``full``: the smallest weighted sum of distances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from app.recognition.decision.confidence import estimate_confidence
from app.recognition.decision.fusion import fuse, weigh_distances, weigh_voters
from app.recognition.decision.hand_references import HandReferences
from app.recognition.decision.motion_references import (
    MAX_GESTURES_TRAVERSED,
    MotionReferences,
    describe_movement,
    find_tempo_dependent,
    find_unambiguous_traversals,
)
from app.recognition.decision.moving_shapes import WEIGHT, MovingShapes, weigh_shapes
from app.recognition.decision.references import References
from app.recognition.decision.rejection import (
    CUE_GROUPS,
    HAND_CUE_GROUP,
    build_novelty_weights,
    gather_thresholds,
    is_rejected,
    measure_clearness,
    measure_group_novelties,
)
from app.recognition.decision.result import Recognition
from app.recognition.decision.score_table import ScoreTable
from app.recognition.decision.shape_references import ShapeReferences
from app.recognition.decision.virtual_views import View, Views
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.switches import Sensitivity
from app.recognition.gestures.tuning import AS_THE_PROFILE, Tuning
from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.held_hands import find_least_movement, measure_movement
from app.recognition.voters.motion.tempo import Tempo
from app.recognition.voters.registry import (
    HAND_VOTER_NAMES,
    PAPER_VOTERS,
    VOTER_NAMES,
    VOTERS,
)

_SHAPES = len(PAPER_VOTERS)
_TEMPO = VOTER_NAMES.index(Tempo.name)
_NOVELTY_WEIGHTS = build_novelty_weights(VOTER_NAMES)
_ALL_NAMES = (*VOTER_NAMES, *HAND_VOTER_NAMES)

CLOSE_SCORES = 0.05
"""Tolerance in score of `FusedVote.may_win`: a new weight may select another traversal, which is
usually nearer by about as much."""


class FusedVote:
    """Fuses the distances of all voters, weighted by how well each separates the gestures.

    Parameters
    ----------
    gestures
        G gestures, at least one.
    tuning
        Its weight factors multiply the voters' weights in this language.

    Raises
    ------
    OsgError
        When the weights do not fit the voters.

    """

    def __init__(self, gestures: Sequence[Gesture], tuning: Tuning = AS_THE_PROFILE) -> None:
        self._labels = tuple(gesture.label for gesture in gestures)
        self._shown = References.of(gestures)
        sides, self._owners = self._shown.gestures, self._shown.owners
        self._shapes = ShapeReferences(sides, tuning.simplification)
        self._motions = MotionReferences.of(sides)
        self._hands = HandReferences.of(sides, self._owners)
        self._moving_shapes = MovingShapes.of(sides, self._owners)
        self._least_movement = find_least_movement(
            gesture.trajectory
            for gesture in sides
            if gesture.trajectory is not None and not gesture.is_held and len(self._hands)
        )
        self._tempo = np.array([gesture.switches.tempo == "on" for gesture in sides])
        self._calibrate(sides)
        # Set last, because weight factors must not change which directions and tempos the language
        # needs.
        self._factors = tuning.weights_of(VOTER_NAMES)
        self._weights: FloatArray = self._weights * self._factors
        self._draws = self._needs_drawings()
        if not self._draws:
            self._weights[:_SHAPES] = 0.0
        self._thresholds = gather_thresholds(sides, VOTER_NAMES)
        self._hand_thresholds = gather_thresholds(sides, HAND_VOTER_NAMES)
        self._simplification = tuning.simplification
        self._views = self._prepare_views()

    def _prepare_views(self) -> Views:
        shapes = self._shapes if self._draws else None
        return Views(self._shown.gestures, shapes, self._motions, self._simplification)

    def _calibrate(self, sides: Sequence[Gesture]) -> None:
        """Compute the weights, and which directions and tempos the language needs."""
        first_rows = self._motions.as_shown[:MAX_GESTURES_TRAVERSED]
        own = self._motions.own_distances
        one, other = np.triu_indices(len(first_rows), 1)
        owners = self._owners[self._motions.gestures[first_rows]]
        apart = owners[one] != owners[other]
        pairs = own[:, :, first_rows][:, one[apart], other[apart]]
        shapes = self._shapes.own_distances(MAX_GESTURES_TRAVERSED)
        self._weights, self._between = weigh_voters(
            VOTERS,
            [*shapes, *(row[np.isfinite(row)] for row in pairs)],
            max(1, len(self._motions.landmarks)),
        )
        if len(first_rows) < len(self._motions.as_shown):
            return
        self._tempo = find_tempo_dependent(
            self._motions, own, *self._of_motion, sides, self._owners
        )
        self._moving_shapes = self._moving_shapes.with_twins(sides, self._compare_movements_of(own))
        free = [
            owner
            for owner, gesture in zip(self._owners, sides, strict=True)
            if gesture.switches.direction == "off"
        ]
        kept = find_unambiguous_traversals(self._motions, own, *self._of_motion, self._owners, free)
        self._motions = self._motions.take(kept)

    def _compare_movements_of(self, own: FloatArray) -> FloatArray:
        """Return the scores of the references' movements as shown, ``(S, S)``; infinite if none."""
        rows = self._motions.as_shown
        scores = np.full((len(self._owners), len(self._owners)), np.inf)
        members = self._motions.gestures[rows]
        scores[np.ix_(members, members)] = fuse(own[:, :, rows], *self._of_motion)
        return scores

    def _needs_drawings(self) -> bool:
        """Return whether a gesture has only a drawing, or the tuning raises a shape voter."""
        with_movement = set(self._motions.gestures.tolist())
        raised = self._factors[:_SHAPES].max() > np.median(self._factors[_SHAPES:])
        return bool(raised) or not with_movement.issuperset(self._shapes.members)

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

    def find_counting_hands(self, gesture: int) -> tuple[HandShape, ...]:
        """Return the hands whose shape counts in a gesture's movement, of one demonstration.

        It is the first one in which they are known. Empty where their shape does not count.
        """
        counting = self._moving_shapes.counting & (self._owners == gesture)
        first = np.flatnonzero(counting)[:1].tolist()
        return tuple(hand for row in first for hand in self._moving_shapes.shapes[row].values())

    @property
    def landmarks(self) -> tuple[str, ...]:
        """The salient landmarks of all gestures, in alphabetical order."""
        return self._motions.landmarks

    @property
    def needed(self) -> tuple[str, ...]:
        """The landmarks that any gesture needs, in alphabetical order."""
        return self._shapes.needed

    @property
    def unnormalized_weights(self) -> dict[str, float]:
        """Each voter's weight before normalisation; 0 if it does not separate the gestures."""
        return dict(zip(VOTER_NAMES, self._weights.tolist(), strict=True))

    @cached_property
    def weights(self) -> Mapping[str, float]:
        """Each voter's weight in the decision, summing to 1."""
        weights = self._weights.copy()
        if self._tempo.any():
            weights[_TEMPO] += Tempo.weight_where_needed
        names = VOTER_NAMES
        if self._moving_shapes.any_counts:
            names = _ALL_NAMES
            weights = np.append(weights, np.full(len(HAND_VOTER_NAMES), WEIGHT / 2))
        normalized = (weights / weights.sum()).tolist()
        return MappingProxyType(dict(zip(names, normalized, strict=True)))

    @property
    def between(self) -> dict[str, float]:
        """Each voter's between-class distance in this language."""
        return dict(zip(VOTER_NAMES, self._between.tolist(), strict=True))

    @property
    def _of_motion(self) -> tuple[FloatArray, FloatArray]:
        """Weights and between-class distances of the motion voters alone."""
        return self._weights[_SHAPES:], self._between[_SHAPES:]

    @property
    def references(self) -> MotionReferences:
        """The gestures' movements in all traversals that are not ambiguous in the language."""
        return self._motions

    def with_thresholds(self, thresholds: FloatArray) -> FusedVote:
        """Return the same vote with other thresholds, ``(V, G)``."""
        other = copy(self)
        other._thresholds = thresholds[:, self._owners]
        return other

    def among(self, gestures: npt.NDArray[np.intp]) -> FusedVote:
        """Return the same vote between some of the gestures, given in ascending order.

        Weights, thresholds and traversals stay those of the whole language.
        """
        shown, sides = self._shown.take(gestures)
        rows = np.flatnonzero(np.isin(self._motions.gestures, sides))
        motions = self._motions.take(rows)
        other = copy(self)
        other.__dict__.pop("weights", None)
        other._labels = tuple(self._labels[index] for index in gestures.tolist())
        other._shown, other._owners = shown, shown.owners
        other._shapes = self._shapes.take(sides)
        other._motions = replace(motions, gestures=np.searchsorted(sides, motions.gestures))
        other._tempo = self._tempo[sides]
        other._thresholds = self._thresholds[:, sides]
        other._hands = self._hands.take(sides)
        other._moving_shapes = self._moving_shapes.take(sides, other._owners)
        other._hand_thresholds = self._hand_thresholds[:, sides]
        other._views = other._prepare_views()
        return other

    def compare(self, trajectory: Trajectory, *, drawn: bool = True) -> ScoreTable:
        """Compare a condensed query with the nearest demonstration of every gesture.

        Mirror images count as demonstrations. Demonstrations with depth are turned to face as the
        diver of the query does (`views`); where that is not known, to the view in which one of them
        is nearest.

        The shape voters are used only where a gesture has no demonstration or the tuning raises the
        weight of one of them. Otherwise they would take a quarter of the time and change no set's
        accuracy by more than sampling error (`benchmarks/studies/people.md`). Without `drawn` they
        are left out in any case.

        A query that holds one hand shape is compared with the held shapes, a query that holds two
        in sequence with the sequences, and any other query with the movements. A query that holds a
        shape and moves about as little as the smallest movement is compared with both: it is the
        movement if it is accepted as one, otherwise the alternative of lower novelty.
        """
        if not len(self._hands):
            return self._compare_movements(trajectory, drawn)
        held = self._compare_hands(trajectory) if trajectory.hands else None
        if held is not None and measure_movement(trajectory) < self._least_movement:
            return held
        moved = self._compare_movements(trajectory, drawn)
        if not self._moving_shapes.any_counts:
            moved = moved.with_idle_voters(HAND_VOTER_NAMES)
        if held is None or not is_rejected(_measure_novelty(moved)):
            return moved
        return min(held, moved, key=_measure_novelty)

    def _compare_movements(self, trajectory: Trajectory, drawn: bool) -> ScoreTable:
        """Compare a movement with those of the language."""
        views = self._views.list_for(trajectory.facing)
        tables = [self._compare_in(view, trajectory, drawn) for view in views]
        return min(tables, key=lambda table: float(table.scores.min()))

    def _compare_hands(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a held hand shape with those of the language."""
        sides = self._hands.distances(trajectory.held_shapes)
        shares = weigh_distances(sides, self._hands.weights, self._hands.between)
        chosen = self._shown.find_nearest(shares.sum(axis=0))
        distances = np.full((len(_ALL_NAMES), len(chosen)), np.inf)
        contributions = np.zeros(distances.shape)
        distances[len(VOTERS) :] = sides.take(chosen, axis=1)
        contributions[len(VOTERS) :] = shares.take(chosen, axis=1)
        novelty = np.full((len(CUE_GROUPS) + 1, len(chosen)), np.nan)
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

    def _compare_in(self, view: View, trajectory: Trajectory, drawn: bool) -> ScoreTable:
        distances, rows = self._compare_sides(view, trajectory, drawn)
        shares = weigh_distances(distances, self._weights, self._between)
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
        voters, novelty = VOTER_NAMES, factors * self._novelty_by_view(distances)
        compared = scores + turned
        hand_novelty = np.empty((0, len(rows)))
        if self._moving_shapes.any_counts:
            voters = _ALL_NAMES
            hands = self._compare_moving_hands(trajectory, rows, compared)
            distances = np.concatenate([distances, hands])
            shares = np.concatenate([shares, weigh_shapes(hands)])
            compared = shares.sum(axis=0) + turned
            hand_novelty = self._hand_novelty(hands)[None]
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
            novelty_by_view=np.concatenate(
                [
                    novelty.take(chosen, axis=1) * measure_clearness(compared[chosen]),
                    hand_novelty.take(chosen, axis=1),
                ]
            ),
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
        """Return the novelties ``(sides,)`` of hand voters' distances; NaN without thresholds."""
        weights = np.ones((1, len(HAND_VOTER_NAMES)))
        novelty: FloatArray = measure_group_novelties(distances, self._hand_thresholds, weights)[0]
        return novelty

    def fuse(self, distances: FloatArray) -> FloatArray:
        """Return the scores of distances ``(V, N)`` by the language's weights, ``(N,)``."""
        return fuse(distances, self._weights, self._between)

    def _novelty_by_view(self, distances: FloatArray) -> FloatArray:
        return measure_group_novelties(
            distances, self._thresholds, self._factors * _NOVELTY_WEIGHTS
        )

    def recognize(self, trajectory: Trajectory) -> Recognition | None:
        """Recognise a condensed query; None if no landmark that a gesture needs moves."""
        compared = self.compare(trajectory)
        return self.decide(compared) if np.isfinite(compared.scores).any() else None

    def may_win(
        self, table: ScoreTable, result: Recognition, gesture: int, voter: str, factor: float
    ) -> bool:
        """Return whether a gesture comes close to the least score when a voter is reweighted."""
        if voter in HAND_VOTER_NAMES:  # which have no weight factors
            return False
        comparable = np.isfinite(table.scores)
        scores = table.scores
        added = table.contributions[table.voters.index(voter)]
        scores[comparable] += (factor - 1) * added[comparable]
        return bool(comparable[gesture] and scores[gesture] < scores.min() + CLOSE_SCORES)

    def decide(self, compared: ScoreTable) -> Recognition:
        """Return the gesture with the smallest score, or a rejection if its novelty is above 1.

        One of the scores must be finite.
        """
        distances, scores, novelty = compared.distances, compared.scores, compared.novelty
        winner = int(scores.argmin())
        able = np.flatnonzero(np.isfinite(distances).any(axis=1)).tolist()
        nearest_by_voter = distances.argmin(axis=1)
        nearest = self._labels[winner]
        return Recognition(
            label=None if is_rejected(float(novelty[winner])) else nearest,
            nearest=nearest,
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
            novelty_by_view=dict(
                zip((*CUE_GROUPS, HAND_CUE_GROUP), compared.novelty_by_view, strict=False)
            ),
            facing=compared.facing,
            views=compared.views.astype(np.float64),
        )

    def _weights_in(self, compared: ScoreTable) -> Mapping[str, float]:
        """Return the voters' weights in a decision: of the movement, or of the held hands."""
        if not len(self._hands):
            return self.weights
        by_hand = not np.isfinite(compared.distances[: len(VOTERS)]).any()
        shares = (self._hands.weights / self._hands.weights.sum()).tolist()
        of_hand = dict(zip(HAND_VOTER_NAMES, shares, strict=True))
        if by_hand:
            return MappingProxyType(dict.fromkeys(VOTER_NAMES, 0.0) | of_hand)
        return MappingProxyType(dict.fromkeys(HAND_VOTER_NAMES, 0.0) | {**self.weights})

    def _compare_sides(
        self, view: View, trajectory: Trajectory, drawn: bool
    ) -> tuple[FloatArray, npt.NDArray[np.intp]]:
        """Return ``(V, sides)`` distances and ``(sides,)`` rows of the traversals, -1: none."""
        distances = np.full((len(VOTERS), len(self._owners)), np.inf)
        if drawn and view.shapes is not None:
            distances[:_SHAPES] = view.shapes.distances(trajectory)
            comparable = np.asarray(np.isfinite(distances[:_SHAPES]).any(axis=0))
        elif drawn:
            comparable = self._shapes.find_comparable(trajectory)
        else:
            shown = not set(self.needed).isdisjoint(trajectory.landmarks)
            comparable = np.full(len(self._owners), shown)
        rows = np.full(len(self._owners), -1, dtype=np.intp)
        if len(self._motions) and len(trajectory) > 1 and comparable.any():
            query = describe_movement(trajectory, self._motions.landmarks)
            nearest = view.motions.find_nearest(query, *self._of_motion, len(self._owners))
            rows, distances[_SHAPES:] = nearest.rows, nearest.distances
            distances[_SHAPES:, ~comparable] = np.inf
        return distances, rows


def _measure_novelty(table: ScoreTable) -> float:
    """Return the novelty of a query for its nearest gesture; 0 if that has no thresholds."""
    if not np.isfinite(table.scores).any():
        return np.inf
    return float(np.nan_to_num(table.novelty[table.scores.argmin()], posinf=np.inf))
