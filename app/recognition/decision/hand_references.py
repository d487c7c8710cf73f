"""Hand references: a language's hand shapes, held or carried by a movement, for the hand voters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.decision.fusion import weigh_distances
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.frame import SIDES, HandShape, Side, mirror_hands
from app.recognition.poses.sequence import FloatArray
from app.recognition.preprocessing.moving_hands import list_moving_sides
from app.recognition.voters.registry import HAND_VOTERS

BETWEEN: Final = np.array([voter.between for voter in HAND_VOTERS])
"""The hand voters' distances between two shapes: a language has too few shapes to measure its own.
"""

HAND_LIMIT: Final = 0.45
"""Largest share of the distance between two hand shapes that is accepted as the same one, for every
shape and language (`benchmarks/studies/hand-shapes.md`)."""

SAME_SHAPE: Final = 0.3
"""Score below which two held shapes are the same one: that of half of the takes from another view.
"""

MOST_TURNED: Final = 45.0
"""Degrees by which a moving hand may be turned in the image at no cost, more than a held one: it
turns with the arm, whose elbow is elsewhere in another take (`benchmarks/studies/hand-shapes.md`).
"""

SAME_MOVEMENT: Final = 0.3
"""Score below which two gestures may be the same movement with two hand shapes: most of one
person's pairs of takes are below it, and few pairs of different movements
(`benchmarks/studies/hand-shapes.md`)."""

OTHER_SHAPE: Final = 0.5
"""Mean relative distance of the hand voters from which two shapes are clearly different: beyond
99 % of the pairs of takes of one shape and view (0.45), below 99 % of those of two signs (0.61)."""

WEIGHT: Final = 0.5
"""Amount added to the score of a gesture whose hand shape counts, for a shape as different as that
of another sign: more than the score between two takes of one movement, less than that between two
movements."""

HeldShapes = Sequence[Sequence[HandShape]]
"""The hands of one shape, or of two in sequence (`Trajectory.held_shapes`)."""

MovingShapes = Mapping[Side, HandShape]
"""By side the shapes of the hands that carry a movement; empty where none is known."""


@dataclass(frozen=True, eq=False)
class HeldReferences:
    """The demonstrations of a language that hold a hand shape, M of them.

    Attributes
    ----------
    members
        ``(M,)``: their indices among all demonstrations.
    shapes
        Their hands: of one shape, or of two in sequence.
    mirrored
        ``(M,)``: whether the mirror image, shown with the other hand or the back of the hand, is
        the same gesture.

    """

    members: npt.NDArray[np.intp]
    shapes: tuple[HeldShapes, ...]
    mirrored: npt.NDArray[np.bool_]

    @classmethod
    def of(cls, shown: Sequence[Gesture], owners: npt.NDArray[np.intp]) -> HeldReferences:
        """Return the held ones of S demonstrations.

        The mirror image of a shape is the same gesture, unless the gesture's switch is off, or it
        is automatic and the mirror image is another gesture of the language.

        Parameters
        ----------
        shown
            S gestures of one demonstration each.
        owners
            ``(S,)``: index of each one's gesture in the language.

        """
        members = np.flatnonzero([each.is_held for each in shown])
        held = [each for each in shown if each.is_held]
        shapes = tuple(each.held_shapes for each in held)
        switches = np.array([each.switches.mirror for each in held])
        if not len(members):
            return cls(members, shapes, np.zeros(0, dtype=bool))
        as_shown = cls(members, shapes, np.zeros(len(members), dtype=bool))
        turned = np.array([score_hands(as_shown.distances(_mirror(each))) for each in shapes])
        apart = owners[members][:, None] != owners[members]
        other = ((turned < SAME_SHAPE) & apart).any(axis=1)
        return replace(as_shown, mirrored=(switches == "on") | (switches == "auto") & ~other)

    def __len__(self) -> int:
        """Return M."""
        return len(self.members)

    def distances(self, shapes: HeldShapes) -> FloatArray:
        """Compute the distances of held hands to all M demonstrations.

        A demonstration of one hand is compared with each hand of the query, one of two hands with
        both; the nearest arrangement counts. Two shapes in sequence are compared in their order and
        with the same hand; the farther one counts, so that both must fit.

        Returns
        -------
        ``(3, M)`` by voter; infinite for demonstrations of another number of shapes, or of more
        hands than the query has.

        """
        nearest = np.full((len(HAND_VOTERS), len(self)), np.inf)
        scores, every = np.full(len(self), np.inf), np.ones(len(self), dtype=bool)
        for seen, allowed in ((shapes, every), (_mirror(shapes), self.mirrored)):
            for hands in (1, 2):
                rows = np.flatnonzero(allowed & (self._numbers == (len(shapes), hands)).all(axis=1))
                for arranged in _arrange(seen, hands) if len(rows) else ():
                    found, score = self._compare(arranged, rows)
                    better = score < scores[rows]
                    scores[rows[better]], nearest[:, rows[better]] = score[better], found[:, better]
        return nearest

    def _compare(
        self, shapes: HeldShapes, rows: npt.NDArray[np.intp]
    ) -> tuple[FloatArray, FloatArray]:
        """Return distances ``(3, m)`` and scores ``(m,)`` of the farther shape of m references."""
        found, score = np.zeros((len(HAND_VOTERS), len(rows))), np.full(len(rows), -1.0)
        for hands, described in zip(shapes, self._described, strict=False):
            apart = [
                _measure(hand, [each[rows] for each in of_hand])
                for hand, of_hand in zip(hands, described, strict=False)
            ]
            part = apart[0] if len(apart) == 1 else np.mean(apart, axis=0)
            farther = score_hands(part)
            found = np.where(farther > score, part, found)
            score = np.maximum(farther, score)
        return found, score

    @cached_property
    def _numbers(self) -> npt.NDArray[np.intp]:
        """``(M, 2)``: numbers of shapes and of hands."""
        return np.array([(len(each), len(each[0])) for each in self.shapes], dtype=np.intp)

    @cached_property
    def _described(self) -> list[list[list[FloatArray]]]:
        """By shape, hand and voter the descriptors ``(M, D)``.

        The last hand and shape stand in for missing ones, which are never compared.
        """
        return [
            [
                [
                    np.array([voter.describe(each[part][place]) for each in self._filled])
                    for voter in HAND_VOTERS
                ]
                for place in range(2)
            ]
            for part in range(2)
        ]

    @property
    def _filled(self) -> list[HeldShapes]:
        """The shapes, each filled up to two shapes of two hands with its last ones."""
        filled = [[[*hands, hands[-1]][:2] for hands in each] for each in self.shapes]
        return [[*each, each[-1]][:2] for each in filled]


@dataclass(frozen=True, eq=False)
class MovingReferences:
    """The shapes of the hands that carry a language's movements, of S demonstrations.

    Attributes
    ----------
    shapes
        Of each demonstration.
    owners
        ``(S,)``: index of each one's gesture in the language.
    counting
        ``(S,)``: whether the shape counts.
    twins
        Pairs of gestures, the first index the smaller, that are the same movement with two shapes
        that both count.
    undecided
        Pairs that would be twins: their hands differ clearly, and nobody has said on purpose.

    """

    shapes: tuple[MovingShapes, ...]
    owners: npt.NDArray[np.intp]
    counting: npt.NDArray[np.bool_]
    twins: frozenset[tuple[int, int]] = frozenset()
    undecided: frozenset[tuple[int, int]] = frozenset()

    @classmethod
    def of(
        cls, shown: Sequence[Gesture], owners: npt.NDArray[np.intp], movements: FloatArray
    ) -> MovingReferences:
        """Return the shapes of S demonstrations, and find which of them count.

        Divers draw with any hand, and one demonstration does not tell whether its hand is meant
        (`benchmarks/studies/voters.md`). So those shapes count whose switch is on, and
        automatically those of two gestures of the same movement that several demonstrations of
        both show alike, and clearly otherwise than the other gesture. With single demonstrations
        such a pair is undecided.

        Parameters
        ----------
        shown
            S gestures of one demonstration each.
        owners
            ``(S,)``: index of each one's gesture in the language.
        movements
            ``(S, S)``: scores of the demonstrations' movements; infinite where not comparable.

        """
        shapes = tuple(_find_shapes(each) for each in shown)
        known = np.array([bool(each) for each in shapes], dtype=bool)
        switches = np.array([each.switches.hand_shape for each in shown])
        counting = known & (switches == "on")
        if known.sum() < 2:
            return cls(shapes, owners, counting)
        apart = np.array([[measure_shapes(one, other) for other in shapes] for one in shapes])
        rows = [owners == owner for owner in range(int(owners.max()) + 1)]
        found = _find_pairs(rows, movements, apart)
        agreeing = [_agree(apart, known & each & (switches != "off")) for each in rows]
        for one, other in found:
            if agreeing[one] and agreeing[other]:
                counting |= known & (rows[one] | rows[other])
        counts = [bool(counting[each].any()) for each in rows]
        open_to_all = [bool((switches[each] == "off").any()) for each in rows]
        twins = {(one, other) for one, other in found if counts[one] and counts[other]}
        undecided = {pair for pair in found - twins if not any(open_to_all[each] for each in pair)}
        return cls(shapes, owners, counting, frozenset(twins), frozenset(undecided))

    @cached_property
    def any_counts(self) -> bool:
        """Whether any shape counts."""
        return bool(self.counting.any())

    def distances(self, hands: Sequence[HandShape], *, exchanged: bool) -> FloatArray:
        """Compute the distances of a query's moving hands to all demonstrations.

        Every hand that carries a demonstration's movement is compared with the query's hand of the
        same side, and with its mirror image; a demonstration whose shape is not known is as far as
        the nearest other one of its gesture.

        Parameters
        ----------
        hands
            Of the query.
        exchanged
            Whether the query's left and right are exchanged.

        Returns
        -------
        ``(3, S)`` by voter; infinite where the shape does not count or is not known.

        """
        seen = {_other(hand.side) if exchanged else hand.side: hand for hand in hands}
        found = np.full((len(HAND_VOTERS), len(self.shapes)), np.inf)
        for index in np.flatnonzero(self.counting).tolist():
            found[:, index] = compare_shapes(seen, self.shapes[index])
        for owner in np.unique(self.owners[self.counting]):
            rows = np.flatnonzero(self.owners == owner)
            nearest = rows[int(found[:, rows].sum(axis=0).argmin())]
            found[:, rows[~self.counting[rows]]] = found[:, [nearest]]
        return found


def weigh_hands(distances: FloatArray) -> FloatArray:
    """Return what each voter's distances ``(3, ...)`` contribute to the score, in that shape.

    A third of the distance over the voter's `between`; infinite where nothing can be compared.
    """
    return weigh_distances(distances, np.ones(len(HAND_VOTERS)), BETWEEN)


def score_hands(distances: FloatArray) -> FloatArray:
    """Return the scores of hand voters' distances ``(3, ...)``: 1 for two shapes, typically."""
    return np.asarray(weigh_hands(distances).sum(axis=0))


def measure_hand_novelty(distances: FloatArray) -> FloatArray:
    """Return the novelties of hand voters' distances ``(3, ...)``; NaN where not comparable."""
    score = score_hands(distances)
    return np.where(np.isfinite(score), score / HAND_LIMIT, np.nan)


def weigh_moving_hands(distances: FloatArray) -> FloatArray:
    """Return what distances ``(3, M)`` add to the scores, by voter; 0 where not comparable.

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


def measure_shapes(seen: MovingShapes, shown: MovingShapes) -> float:
    """Return the mean relative distance of the hand voters; infinite without a common side."""
    return float(score_hands(compare_shapes(seen, shown)))


def compare_shapes(seen: MovingShapes, shown: MovingShapes) -> FloatArray:
    """Return the voters' mean distances over the hands of the same sides: ``(3,)``.

    Of each hand and its mirror image, the palm or the back, the nearer one counts. Infinite without
    a common side.
    """
    pairs = [
        min(
            (_measure_turned(each, shown[side]) for each in (seen[side], seen[side].mirror())),
            key=lambda found: float(score_hands(found)),
        )
        for side in SIDES
        if side in seen and side in shown
    ]
    return np.mean(pairs, axis=0) if pairs else np.full(len(HAND_VOTERS), np.inf)


def _measure(hand: HandShape, described: Sequence[FloatArray]) -> FloatArray:
    """Return the voters' distances of a hand to those of m demonstrations, ``(3, m)``."""
    return np.array(
        [
            voter.distances(voter.describe(hand), others)
            for voter, others in zip(HAND_VOTERS, described, strict=True)
        ]
    )


def _measure_turned(seen: HandShape, shown: HandShape) -> FloatArray:
    """Return the voters' distances ``(3,)`` of two moving hands."""
    return np.concatenate(
        [
            voter.distances_turned(voter.describe(seen), voter.describe(shown)[None], MOST_TURNED)
            for voter in HAND_VOTERS
        ]
    )


def _find_pairs(
    rows: Sequence[npt.NDArray[np.bool_]], movements: FloatArray, apart: FloatArray
) -> set[tuple[int, int]]:
    """Return pairs of gestures of one movement whose hands differ; `rows` of each gesture."""
    found = set()
    for one, other in combinations(range(len(rows)), 2):
        pair = np.ix_(rows[one], rows[other])
        alike = min(movements[pair].min(), movements.T[pair].min()) < SAME_MOVEMENT
        if alike and OTHER_SHAPE < apart[pair].min() < np.inf:
            found.add((one, other))
    return found


def _agree(apart: FloatArray, members: npt.NDArray[np.bool_]) -> bool:
    """Return whether several demonstrations show one shape; `apart` is ``(S, S)``."""
    shown = np.flatnonzero(members)
    return len(shown) > 1 and bool(apart[np.ix_(shown, shown)].max() <= OTHER_SHAPE)


def _find_shapes(gesture: Gesture) -> MovingShapes:
    """Return the shapes of the hands that carry a gesture of one demonstration."""
    if gesture.trajectory is None:
        return {}
    sides = list_moving_sides(gesture.salient)
    return {hand.side: hand for hand in gesture.trajectory.moving_hands if hand.side in sides}


def _mirror(shapes: HeldShapes) -> HeldShapes:
    return tuple(mirror_hands(hands) for hands in shapes)


def _arrange(shapes: HeldShapes, count: int) -> list[HeldShapes]:
    """Return every choice of one hand, or both in order of their sides; none of too few hands."""
    sides = [hand.side for hand in shapes[0]] if shapes else []
    if count > len(sides):
        return []
    if count == 1:
        return [[(hands[index],) for hands in shapes] for index in range(len(sides))]
    return [[sorted(hands, key=lambda hand: SIDES.index(hand.side)) for hands in shapes]]


def _other(side: Side) -> Side:
    return SIDES[1 - SIDES.index(side)]
