"""Hand references: the held hand shapes of a language, for the hand voters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from app.recognition.decision.fusion import fuse, weigh_voters
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.frame import SIDES
from app.recognition.poses.hand_shape import HandShape
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.registry import HAND_VOTERS

SAME_SHAPE = 0.25
"""Score below which two held shapes are the same one: that of most takes from another view."""

Described = list[FloatArray]
"""Per voter the descriptors of M hands, ``(M, D)``."""


@dataclass(frozen=True, eq=False)
class HandReferences:
    """The held hand shapes among S references of a language.

    Attributes
    ----------
    count
        S.
    rows
        ``(M,)``: indices of the references that hold a shape.
    hands
        Their hands.
    mirrored
        ``(M,)``: whether the mirror image is the same gesture: shown with the other hand, or with
        the back of the hand.
    weights, between
        ``(2,)`` of the hand voters, see `fusion.weigh_voters`.

    """

    count: int
    rows: npt.NDArray[np.intp]
    hands: tuple[tuple[HandShape, ...], ...]
    mirrored: npt.NDArray[np.bool_]
    weights: FloatArray
    between: FloatArray

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
        held = [
            (row, each.trajectory.hands)
            for row, each in enumerate(gestures)
            if each.trajectory is not None and each.trajectory.hands
        ]
        rows = np.array([row for row, _ in held], dtype=np.intp)
        hands = tuple(each for _, each in held)
        switches = [gestures[row].switches.mirror for row in rows]
        made = cls(
            count=len(gestures),
            rows=rows,
            hands=hands,
            mirrored=np.array([switch != "off" for switch in switches], dtype=bool),
            weights=np.ones(len(HAND_VOTERS)),
            between=np.array([voter.between for voter in HAND_VOTERS]),
        )
        if not held:
            return made
        apart = owners[rows][:, None] != owners[rows]
        shown = replace(made, mirrored=np.zeros(len(rows), dtype=bool))
        own = np.array([shown.distances(each)[:, rows] for each in hands])
        pairs = [own[:, voter][apart] for voter in range(len(HAND_VOTERS))]
        weights, between = weigh_voters(
            HAND_VOTERS, [pair[np.isfinite(pair)] for pair in pairs], landmarks=1
        )
        turned = np.array([shown.distances(_mirror(each))[:, rows] for each in hands])
        alike = (fuse(turned.transpose(1, 0, 2), weights, between) < SAME_SHAPE) & apart
        other = np.array([switch == "auto" for switch in switches]) & alike.any(axis=1)
        return replace(made, mirrored=made.mirrored & ~other, weights=weights, between=between)

    def __len__(self) -> int:
        """Return M, the number of references that hold a shape."""
        return len(self.rows)

    def take(self, references: npt.NDArray[np.intp]) -> HandReferences:
        """Return the references among some of the S, given in ascending order."""
        kept = np.flatnonzero(np.isin(self.rows, references))
        return replace(
            self,
            count=len(references),
            rows=np.searchsorted(references, self.rows[kept]),
            hands=tuple(self.hands[index] for index in kept.tolist()),
            mirrored=self.mirrored[kept],
        )

    def distances(self, hands: Sequence[HandShape]) -> FloatArray:
        """Compute the distances of held hands to all references.

        A reference of one hand is compared with each hand of the query, one of two hands with
        both, in the arrangement in which it is nearest.

        Returns
        -------
        ``(2, S)`` by voter; infinite for references that hold no shape, or more hands than the
        query.

        """
        nearest = np.full((len(HAND_VOTERS), self.count), np.inf)
        scores = np.full(self.count, np.inf)
        for number, (members, described) in self._described.items():
            for seen, allowed in ((tuple(hands), True), (_mirror(hands), self.mirrored[members])):
                for arranged in _arrange(seen, number):
                    found = _compare(arranged, described)
                    score = fuse(found, self.weights, self.between)
                    better = (score < scores[self.rows[members]]) & allowed
                    rows = self.rows[members[better]]
                    scores[rows], nearest[:, rows] = score[better], found[:, better]
        return nearest

    @cached_property
    def _described(self) -> dict[int, tuple[npt.NDArray[np.intp], list[Described]]]:
        """By the number of hands the places of its references in `rows`, and their hands."""
        by_number: dict[int, tuple[npt.NDArray[np.intp], list[Described]]] = {}
        for number in sorted({len(each) for each in self.hands}):
            members = np.flatnonzero([len(each) == number for each in self.hands])
            by_number[number] = (
                members,
                [
                    [
                        np.array([voter.describe(self.hands[index][hand]) for index in members])
                        for voter in HAND_VOTERS
                    ]
                    for hand in range(number)
                ],
            )
        return by_number


def _mirror(hands: Sequence[HandShape]) -> tuple[HandShape, ...]:
    return tuple(hand.mirror() for hand in reversed(hands))


def _arrange(hands: Sequence[HandShape], count: int) -> list[tuple[HandShape, ...]]:
    """Return the choices of one hand, or both in order of their sides; none of too few."""
    if count > len(hands):
        return []
    if count == 1:
        return [(hand,) for hand in hands]
    return [tuple(sorted(hands, key=lambda hand: SIDES.index(hand.side)))]


def _compare(hands: Sequence[HandShape], described: Sequence[Described]) -> FloatArray:
    """Return the voters' mean distances of some hands to those of M references, ``(2, M)``."""
    apart = [
        [
            voter.distances(voter.describe(hand), others)
            for voter, others in zip(HAND_VOTERS, each, strict=True)
        ]
        for hand, each in zip(hands, described, strict=True)
    ]
    return np.asarray(np.mean(apart, axis=0))
