"""Moving shapes: the shapes of the hands that carry a language's movements, where they count."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.decision.hand_references import score_hands, weigh_hands
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.frame import SIDES, Side
from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.preprocessing.moving_hands import list_moving_sides
from app.recognition.voters.registry import HAND_VOTERS

MOST_TURNED: Final = 45.0
"""Degrees by which a moving hand may be turned in the image at no cost, more than a held one: it
turns with the arm, whose elbow is elsewhere in another take (`benchmarks/studies/hand-shapes.md`).
"""

SAME_MOVEMENT: Final = 0.3
"""Score below which two gestures may be the same movement with two hand shapes: most of one
person's pairs of takes are below it, and few pairs of different movements
(`benchmarks/studies/people.md`)."""

OTHER_SHAPE: Final = 0.5
"""Mean relative distance of the hand voters from which two shapes are clearly different: beyond
99 % of the pairs of takes of one shape and view (0.45), below 99 % of those of two signs (0.61)."""

WEIGHT: Final = 0.5
"""Amount added to the score of a gesture whose hand shape counts, for a shape as different as that
of another sign: more than the score between two takes of one movement, less than that between two
movements."""

Shapes = dict[Side, HandShape]


@dataclass(frozen=True, eq=False)
class MovingShapes:
    """The hand shapes of S references of a language.

    Attributes
    ----------
    shapes
        S, by side the shape of the hands that carry the reference's movement; empty where none is
        known.
    owners
        ``(S,)``: index of each one's gesture in the language.
    counting
        ``(S,)``: whether the shape counts.
    twins
        Pairs of gestures, the first index the smaller, that are the same movement with two shapes
        that both count.

    """

    shapes: tuple[Shapes, ...]
    owners: npt.NDArray[np.intp]
    counting: npt.NDArray[np.bool_]
    twins: frozenset[tuple[int, int]] = frozenset()

    @classmethod
    def of(cls, gestures: Sequence[Gesture], owners: npt.NDArray[np.intp]) -> MovingShapes:
        """Return the shapes of S references; those count whose switch is on."""
        shapes = tuple(_find_shapes(each) for each in gestures)
        on = [each.switches.hand_shape == "on" for each in gestures]
        counting = np.array(on, dtype=bool) & np.array([bool(each) for each in shapes], dtype=bool)
        return cls(shapes, owners, counting)

    def with_twins(self, gestures: Sequence[Gesture], movements: FloatArray) -> MovingShapes:
        """Return the shapes, in which those that distinguish twins count as well.

        Twins are two gestures of the same movement whose hand shapes differ clearly, also in the
        demonstrations that are nearest to each other.

        Parameters
        ----------
        gestures
            The S references.
        movements
            ``(S, S)``: scores of the references' movements; infinite where not comparable.

        """
        if sum(map(bool, self.shapes)) < 2:
            return self
        apart = np.array([self._compare_all(each) for each in self.shapes])
        known = np.array([bool(each) for each in self.shapes], dtype=bool)
        twins = {
            (one, other)
            for one, other in combinations(range(int(self.owners.max()) + 1), 2)
            if self._are_twins(one, other, movements, apart)
        }
        with_twin = np.isin(self.owners, [owner for pair in twins for owner in pair])
        automatic = np.array([each.switches.hand_shape == "auto" for each in gestures])
        counting = self.counting | (automatic & known & with_twin)
        both = {pair for pair in twins if set(pair) <= set(self.owners[counting].tolist())}
        return replace(self, counting=counting, twins=frozenset(both))

    def _are_twins(self, one: int, other: int, movements: FloatArray, apart: FloatArray) -> bool:
        """Return whether two gestures are the same movement with clearly different shapes."""
        pair = np.ix_(self.owners == one, self.owners == other)
        turned = np.ix_(self.owners == other, self.owners == one)
        nearest = float(apart[pair][np.isfinite(apart[pair])].min(initial=np.inf))
        alike = min(movements[pair].min(), movements[turned].min()) < SAME_MOVEMENT
        return bool(alike and OTHER_SHAPE < nearest < np.inf)

    @cached_property
    def any_counts(self) -> bool:
        """Whether any shape counts."""
        return bool(self.counting.any())

    def distances(self, hands: Sequence[HandShape], exchanged: npt.NDArray[np.bool_]) -> FloatArray:
        """Compute the distances of a query's moving hands to all references.

        Every hand that carries a reference's movement is compared with the query's hand of the
        same side, and with its mirror image; a demonstration whose shape is not known is as far as
        the nearest other one of its gesture.

        Parameters
        ----------
        hands
            Of the query.
        exchanged
            ``(S,)``: whether the query's left and right are exchanged for the reference.

        Returns
        -------
        ``(3, S)`` by voter; infinite where the shape does not count or is not known.

        """
        seen: Shapes = {hand.side: hand for hand in hands}
        other: Shapes = {_other(hand.side): hand for hand in hands}
        found = np.full((len(HAND_VOTERS), len(self.shapes)), np.inf)
        for index in np.flatnonzero(self.counting).tolist():
            found[:, index] = compare_shapes(
                other if exchanged[index] else seen, self.shapes[index]
            )
        for owner in np.unique(self.owners[self.counting]):
            rows = np.flatnonzero(self.owners == owner)
            unknown = rows[~self.counting[rows]]
            nearest = rows[int(found[:, rows].sum(axis=0).argmin())]
            found[:, unknown] = found[:, [nearest]]
        return found

    def _compare_all(self, shapes: Shapes) -> FloatArray:
        """Return how far a reference's shapes are from all, ``(S,)`` mean relative distances."""
        return np.array([measure_shapes(shapes, each) for each in self.shapes])


def measure_shapes(seen: Shapes, shown: Shapes) -> float:
    """Return the mean relative distance of the hand voters; infinite without a common side."""
    return float(score_hands(compare_shapes(seen, shown)))


def weigh_shapes(distances: FloatArray) -> FloatArray:
    """Return what distances ``(3, S)`` add to the scores, by voter; 0 where not comparable.

    The nearest shape adds nothing, so that a gesture whose shape counts is not farther than one
    whose shape does not; the others add the distance by which they exceed it. A take whose shape
    resembles none is rejected by its novelty.
    """
    known = np.isfinite(distances).all(axis=0)
    if not known.any():
        return np.zeros(distances.shape)
    relative = weigh_hands(np.where(known, distances, 0.0))
    whole = relative.sum(axis=0)
    beyond = np.where(known, whole - whole[known].min(), 0.0)
    return np.asarray(WEIGHT * relative * (beyond / np.maximum(whole, 1e-12)))


def compare_shapes(seen: Shapes, shown: Shapes) -> FloatArray:
    """Return the voters' mean distances over the hands of the same sides: ``(3,)``.

    Of each hand and its mirror image, the palm or the back, the nearer one counts. Infinite without
    a common side.
    """
    pairs = [_compare(seen[side], shown[side]) for side in SIDES if side in seen and side in shown]
    if not pairs:
        return np.full(len(HAND_VOTERS), np.inf)
    return np.asarray(np.mean(pairs, axis=0))


def _compare(seen: HandShape, shown: HandShape) -> FloatArray:
    either = [
        np.array(
            [
                voter.distances_turned(
                    voter.describe(hand), voter.describe(shown)[None], MOST_TURNED
                )[0]
                for voter in HAND_VOTERS
            ]
        )
        for hand in (seen, seen.mirror())
    ]
    return min(either, key=lambda found: float(score_hands(found)))


def _find_shapes(gesture: Gesture) -> Shapes:
    """Return the shapes of the hands that carry a gesture of one demonstration."""
    if gesture.trajectory is None:
        return {}
    sides = list_moving_sides(gesture.salient)
    return {hand.side: hand for hand in gesture.trajectory.moving_hands if hand.side in sides}


def _other(side: Side) -> Side:
    return SIDES[1 - SIDES.index(side)]
