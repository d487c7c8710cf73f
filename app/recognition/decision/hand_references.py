"""Hand references: the held hand shapes of a language, for the hand voters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from app.recognition.decision.fusion import weigh_distances
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.frame import SIDES
from app.recognition.poses.hand_shape import HandShape, mirror_hands
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.registry import HAND_VOTERS

BETWEEN: Final = np.array([voter.between for voter in HAND_VOTERS])
"""The hand voters' distances between two shapes: a language has too few shapes to measure its own.
"""

HAND_LIMIT = 0.45
"""Largest share of the distance between two hand shapes that is accepted as the same one, for every
shape and language (`benchmarks/studies/hand-shapes.md`)."""

SAME_SHAPE = 0.3
"""Score below which two held shapes are the same one: that of half of the takes from another view.
"""

Described = list[FloatArray]
"""Per voter the descriptors of M hands, ``(M, D)``."""

HeldShapes = Sequence[Sequence[HandShape]]
"""The hands of one shape, or of two in sequence (`Trajectory.held_shapes`)."""


@dataclass(frozen=True, eq=False)
class HandReferences:
    """The held hand shapes among S references of a language.

    Attributes
    ----------
    count
        S.
    rows
        ``(M,)``: indices of the references that hold a shape.
    shapes
        Their hands: of one shape, or of two in sequence.
    mirrored
        ``(M,)``: whether the mirror image, shown with the other hand or the back of the hand, is
        the same gesture.

    """

    count: int
    rows: npt.NDArray[np.intp]
    shapes: tuple[HeldShapes, ...]
    mirrored: npt.NDArray[np.bool_]

    @classmethod
    def of(cls, gestures: Sequence[Gesture], owners: npt.NDArray[np.intp]) -> HandReferences:
        """Return the references of S gestures of one demonstration each.

        The mirror image of a shape is the same gesture, unless the gesture's switch is off, or it
        is automatic and the mirror image is another gesture of the language.

        Parameters
        ----------
        gestures
            S gestures.
        owners
            ``(S,)``: index of each one's gesture in the language.

        """
        held = [(row, each.held_shapes) for row, each in enumerate(gestures) if each.is_held]
        rows = np.array([row for row, _ in held], dtype=np.intp)
        shapes = tuple(each for _, each in held)
        switches = [gestures[row].switches.mirror for row in rows]
        made = cls(
            count=len(gestures),
            rows=rows,
            shapes=shapes,
            mirrored=np.array([switch != "off" for switch in switches], dtype=bool),
        )
        if not held:
            return made
        apart = owners[rows][:, None] != owners[rows]
        shown = replace(made, mirrored=np.zeros(len(rows), dtype=bool))
        turned = np.array([shown.distances(_mirror(each))[:, rows] for each in shapes])
        alike = (score_hands(turned.transpose(1, 0, 2)) < SAME_SHAPE) & apart
        other = np.array([switch == "auto" for switch in switches]) & alike.any(axis=1)
        return replace(made, mirrored=made.mirrored & ~other)

    def __len__(self) -> int:
        """Return M, the number of references that hold a shape."""
        return len(self.rows)

    def distances(self, shapes: HeldShapes) -> FloatArray:
        """Compute the distances of held hands to all references.

        A reference with one hand is compared with each hand of the query, a reference with two
        hands with both; the nearest arrangement counts. Two shapes in sequence are compared in
        their order and with the same hand; the farther one counts, so that both must fit.

        Returns
        -------
        ``(3, S)`` by voter; infinite for references that hold no shape, another number of shapes,
        or more hands than the query.

        """
        nearest = np.full((len(HAND_VOTERS), self.count), np.inf)
        scores = np.full(self.count, np.inf)
        for number, group in self._described.items():
            if len(shapes) != len(group.parts):
                continue
            members = group.members
            for seen, allowed in ((shapes, True), (_mirror(shapes), self.mirrored[members])):
                for arranged in _arrange(seen, number.hands):
                    found, score = self._compare_parts(arranged, group)
                    better = (score < scores[self.rows[members]]) & allowed
                    rows = self.rows[members[better]]
                    scores[rows], nearest[:, rows] = score[better], found[:, better]
        return nearest

    def _compare_parts(self, shapes: HeldShapes, group: _Group) -> tuple[FloatArray, FloatArray]:
        """Return the distances ``(3, M)`` and scores ``(M,)`` of the farther parts."""
        found = [_compare(*part) for part in zip(shapes, group.parts, strict=True)]
        scores = [score_hands(each) for each in found]
        nearest, score = found[0], scores[0]
        for other, farther in zip(found[1:], scores[1:], strict=True):
            nearest = np.where(farther > score, other, nearest)
            score = np.maximum(farther, score)
        return nearest, score

    @cached_property
    def _described(self) -> dict[_Number, _Group]:
        """The references grouped by their numbers of shapes and hands."""
        numbers = [_Number(len(each), len(each[0])) for each in self.shapes]
        return {
            number: _Group.of(
                np.flatnonzero([each == number for each in numbers]), self.shapes, number
            )
            for number in sorted(set(numbers))
        }


class _Number(NamedTuple):
    """The number of shapes that a reference holds in sequence, and the number of hands."""

    shapes: int
    hands: int


@dataclass(frozen=True, eq=False)
class _Group:
    """M references with the same numbers of shapes and hands.

    Attributes
    ----------
    members
        ``(M,)``: their places in `HandReferences.shapes`.
    parts
        By shape and hand their descriptors.

    """

    members: npt.NDArray[np.intp]
    parts: list[list[Described]]

    @classmethod
    def of(
        cls, members: npt.NDArray[np.intp], shapes: Sequence[HeldShapes], number: _Number
    ) -> _Group:
        chosen = [shapes[index] for index in members.tolist()]
        return cls(
            members,
            [
                [
                    [
                        np.array([voter.describe(each[part][hand]) for each in chosen])
                        for voter in HAND_VOTERS
                    ]
                    for hand in range(number.hands)
                ]
                for part in range(number.shapes)
            ],
        )


def weigh_hands(distances: FloatArray) -> FloatArray:
    """Return what each voter's distances ``(3, ...)`` contribute to the score, in that shape.

    A third of the distance over the voter's `between`; infinite where nothing can be compared.
    """
    return weigh_distances(distances, np.ones(len(HAND_VOTERS)), BETWEEN)


def score_hands(distances: FloatArray) -> FloatArray:
    """Return the scores of hand voters' distances ``(3, ...)``: 1 for two shapes, typically."""
    return np.asarray(weigh_hands(distances).sum(axis=0))


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


def _compare(hands: Sequence[HandShape], described: Sequence[Described]) -> FloatArray:
    """Return the voters' mean distances of some hands to those of M references, ``(3, M)``."""
    apart = [
        [
            voter.distances(voter.describe(hand), others)
            for voter, others in zip(HAND_VOTERS, each, strict=True)
        ]
        for hand, each in zip(hands, described, strict=True)
    ]
    return np.asarray(np.mean(apart, axis=0))
