"""Undoing: changes of a take, and how much nearer each brings it to a demonstration.

A cause is tested by its inverse: the take is mirrored back, reversed, turned upright, or a part of
it or of the demonstration is left out, and both are compared again with the weights and the limit
of the language. A take that is turned over may also lack an end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.fusion import fuse
from app.recognition.decision.references import SMALLER, Described, References, describe_movement
from app.recognition.decision.result import ScoreTable
from app.recognition.features.motion import (
    SHARES,
    SIZE,
    STEPS,
    Movement,
    build_movement,
    find_hands,
)
from app.recognition.features.traversals import AS_SHOWN, Traversal, list_traversals
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.recognizer import Recognizer
from app.recognition.voters.registry import MOTION_VOTERS, VOTER_NAMES

MOST_CUT: Final = 0.2
"""Largest share of a demonstration that is cut off both ends together: more is half a gesture."""

END_CUTS: Final = (0, 1, 3, 5)
"""Steps of 32 that are cut off either end of a demonstration that holds the ways from and to the
salutes."""

USUAL: Final = 0.45
"""Novelty of a right take by another person: what no change is expected to remove."""

OUTSIDE: Final = 0.3
"""Least distance of a part from the other drawing, in sizes of the gesture, that is seen as its own
part."""

Where = Literal["start", "middle", "end"]


@dataclass(frozen=True)
class Part:
    """Consecutive steps of a movement: `first`, and how many there are."""

    where: Where
    first: int
    steps: int

    @cached_property
    def rest(self) -> npt.NDArray[np.intp]:
        """All other steps; a middle part leaves the step at which it begins."""
        begins = self.first + (self.where == "middle")
        return np.concatenate([np.arange(begins), np.arange(self.first + self.steps, STEPS)])


LENGTHS: Final = range(3, STEPS // 2 + 1, 2)
"""Steps of a part that may be missing or added: from a tenth to a half, beyond which the rest is no
longer most of the gesture."""

ENDS: Final = (
    *(Part("start", 0, steps) for steps in LENGTHS),
    *(Part("end", STEPS - steps, steps) for steps in LENGTHS),
)

PARTS: Final = (
    *ENDS,
    *(
        Part("middle", first, steps)
        for steps in LENGTHS
        for first in range(STEPS // 8, STEPS - STEPS // 8 - steps, 3)
    ),
)

LACKS: Final[dict[Where, str]] = {
    "start": "begun_late",
    "middle": "part_missing",
    "end": "ended_early",
}
"""Kinds of what a take lacks, by the part of the demonstration."""


@dataclass(frozen=True, eq=False)
class Undone:
    """A take and a demonstration after one change, or after a turn and a cut.

    Attributes
    ----------
    kind
        The kind of cause that the change would undo, see `causes.CauseKind`.
    novelty
        Distance of the two after it, over the language's limit; above 1 is rejected.
    share
        In [0, 1]: part of the distance beyond `USUAL` that it removes.
    part
        What is left out: of the take for ``part_added``, else of the demonstration.
    query
        The take, turned over if it was.
    also
        What a take that is turned over lacks too: a value of `LACKS`; empty: nothing.

    """

    kind: str
    novelty: float
    share: float
    query: Movement
    part: Part | None = None
    also: str = ""


class Comparison:
    """Compares a take with one demonstration, as they are and after changes.

    Parameters
    ----------
    vote
        Of the language.
    query
        The condensed take.
    gesture
        The gesture with the demonstration that it is compared with, turned to the diver's facing.
    traversal
        The traversal in which it is nearest; None: not compared.
    mirrored
        Whether the gesture's mirror image is nearest.

    """

    def __init__(
        self,
        vote: FusedVote,
        query: Trajectory,
        gesture: Gesture,
        traversal: Traversal | None,
        *,
        mirrored: bool = False,
    ) -> None:
        shown = gesture.mirror() if mirrored else gesture
        assert shown.trajectory is not None
        self._vote, self._query, self._trajectory = vote, query, shown.trajectory
        self._salient = shown.salient
        self.traversal = AS_SHOWN if traversal is None else traversal
        self._landmarks = vote.landmarks
        self._weights = np.array([vote.weights.get(name, 0.0) for name in VOTER_NAMES])
        self._weights[[not voter.prior_for(arms=True) for voter in MOTION_VOTERS]] *= (
            0.0 if vote.references.sees_arms else 1.0
        )
        self._between = np.array([vote.between[name] for name in VOTER_NAMES])

    @cached_property
    def query(self) -> Movement:
        """The take's movement."""
        return build_movement(self._query, self._landmarks)

    @cached_property
    def shown(self) -> tuple[Movement, ...]:
        """The demonstration, first in the nearest traversal, then from each starting point."""
        whole = build_movement(self._trajectory, self._landmarks)
        starts = list_traversals(whole, hands=find_hands(self._salient), both_ways=False)
        nearest = starts[0] if self.traversal.backward else self.traversal
        return tuple(each.of(whole, self._landmarks) for each in (nearest, *starts))

    @cached_property
    def _references(self) -> References:
        """The demonstration as references, which most changes of the take are compared with."""
        return References.of_movements(self.shown, self._landmarks)

    @cached_property
    def _described(self) -> Described:
        """The take's descriptors, with which most changes of the demonstration are compared."""
        return describe_movement(self.query)

    @cached_property
    def base(self) -> float:
        """Novelty of the two as they are; a gesture that is nearest backwards has its penalty."""
        return self.measure(self.query, self.shown)

    def measure(self, query: Movement, shown: Sequence[Movement]) -> float:
        """Return the least novelty of a movement for any of the others."""
        return float(self._measure_all(query, shown).min())

    def _measure_all(self, query: Movement, shown: Sequence[Movement]) -> FloatArray:
        """Return the novelties ``(M,)`` of a movement for M others."""
        known = shown is self.shown
        references = self._references if known else References.of_movements(shown, self._landmarks)
        described = self._described if query is self.query else describe_movement(query)
        scores = fuse(references.measure(described), self._weights, self._between)
        scores *= references.correct(described[SHARES])
        smallness = references.measure_smallness(described[SIZE])
        return np.asarray(scores * smallness / self._vote.limit, dtype=np.float64)

    def undo_all(self) -> Iterator[Undone]:
        """Yield every change with the novelty after it."""
        for kind, turned in self._turn_over():
            yield self._undo(kind, self.measure(turned, self.shown), turned)
            yield from self._leave_out(turned, ENDS, kind)
        yield from self._leave_out(self.query, PARTS)
        for part in PARTS:
            novelty = self.measure(_keep(self.query, part.rest), self.shown)
            yield self._undo("part_added", novelty, self.query, part)

    def _undo(
        self, kind: str, novelty: float, query: Movement, part: Part | None = None, also: str = ""
    ) -> Undone:
        before, after = (max(0.0, each - USUAL) for each in (self.base, novelty))
        share = 1 - after / before if 0 < before < np.inf else float(before > 0 and after < np.inf)
        return Undone(kind, novelty, max(0.0, share), query, part, also)

    def _leave_out(
        self, query: Movement, parts: Sequence[Part], turned: str = ""
    ) -> Iterator[Undone]:
        """Leave out parts of the demonstration that the take may lack."""
        cut = [_keep(self.shown[0], part.rest) for part in parts]
        for part, novelty in zip(parts, self._measure_all(query, cut).tolist(), strict=True):
            lacks = LACKS[part.where]
            yield self._undo(turned or lacks, novelty, query, part, lacks if turned else "")

    def _turn_over(self) -> Iterator[tuple[str, Movement]]:
        """Yield the take mirrored in its place, upright, reversed, with the other arm, larger."""
        yield "mirrored", flip(self.query, (-1, 1))
        yield "upside_down", flip(self.query, (1, -1))
        yield "upside_down", flip(self.query, (-1, -1))
        yield "reversed", self.query.reorder(AS_SHOWN.order[::-1])
        other = build_movement(self._query.mirror(), self._landmarks)
        yield "other_arm", other
        yield "other_arm", flip(other, (-1, 1))
        smaller = float(np.nanmax(np.nan_to_num(self.shown[0].size - self.query.size)))
        if smaller > SMALLER:
            mean = self.query.places.mean(axis=0)
            places = mean + 2.0**smaller * (self.query.places - mean)
            yield "too_small", replace(self.query, places=places)

    def is_drawn(self, undone: Undone) -> bool:
        """Return whether the drawings show a change: the part lies outside of the other one.

        A part that is called added lies off the expected stroke, one that is called missing off
        the take.
        """
        if undone.part is None:
            return True
        added = undone.kind == "part_added"
        whole, other = (undone.query, self.shown[0]) if added else (self.shown[0], undone.query)
        here, there = whole.paths, other.paths - other.paths.mean(axis=0)
        kept = here[undone.part.rest]
        part = np.delete(here, undone.part.rest, axis=0) - kept.mean(axis=0)
        scale = np.sqrt((there**2).sum() / STEPS)
        size = np.sqrt(((kept - kept.mean(axis=0)) ** 2).sum() / len(kept))
        apart = part[:, None] / max(size, 1e-9) - there[None] / max(scale, 1e-9)
        nearest = np.sqrt((apart**2).sum(axis=(2, 3))).min(axis=1)
        return bool(nearest.max() >= OUTSIDE)

    def locate(self, undone: Undone) -> tuple[float, float] | tuple[None, None]:
        """Return the seconds of the take between which a change is seen; None: all of it."""
        if undone.part is None or undone.also:
            return None, None
        reached = self.query.reached
        first, last = undone.part.first, undone.part.first + undone.part.steps - 1
        if undone.kind == "part_added":
            return float(reached[first]), float(reached[last])
        at = {"start": 0, "end": STEPS - 1}.get(undone.part.where, first)
        return float(reached[at]), float(reached[at])


def compare_with(
    recognizer: Recognizer, query: Trajectory, table: ScoreTable, at: int
) -> Comparison | None:
    """Return the comparison of a take with a gesture's nearest demonstration; None without one."""
    shown = table.find_nearest_demonstration(recognizer.language.gestures, at)
    vote = recognizer.vote
    if (
        not isinstance(vote, FusedVote)
        or shown.trajectory is None
        or len(shown.trajectory) < 2
        or len(query) < 2
        or not shown.salient
    ):
        return None
    return Comparison(vote, query, shown, table.traversals[at], mirrored=bool(table.mirrored[at]))


def find_better_range(comparisons: Sequence[Comparison]) -> tuple[float, float] | None:
    """Return the seconds of a demonstration to keep so that takes are nearest to it.

    Parameters
    ----------
    comparisons
        Of takes with this demonstration, at least one.

    Returns
    -------
    By the median take; of cuts that help as much the smaller one, and at most `MOST_CUT`. None
    where none helps.

    """
    best, chosen = float(np.median([each.base for each in comparisons])), None
    shown = comparisons[0].shown[1]
    for before, after in product(END_CUTS, repeat=2):
        cut = (before + after) / STEPS
        kept = _keep(shown, np.arange(before, STEPS - after)) if cut else shown
        typical = float(np.median([each.measure(each.query, [kept]) for each in comparisons]))
        if cut <= MOST_CUT and typical + cut / 4 < best:
            best = typical + cut / 4
            chosen = float(shown.reached[before]), float(shown.reached[STEPS - 1 - after])
    return chosen


def flip(movement: Movement, way: tuple[int, int]) -> Movement:
    """Mirror a movement where it is: every path about its own mean; bones about their direction."""
    factors = np.array(way, dtype=np.float64)
    mean = movement.places.mean(axis=0)
    return replace(
        movement,
        paths=movement.paths * factors,
        limbs=movement.limbs * factors,
        places=mean + (movement.places - mean) * factors,
    )


def _keep(movement: Movement, kept: npt.NDArray[np.intp]) -> Movement:
    """Keep some of a movement's steps, joined, and resample them to `STEPS`."""
    shares = movement.reached / max(float(movement.reached[-1]), 1e-9)
    moments = np.interp(np.linspace(0, 1, STEPS), shares, np.arange(STEPS))
    in_time = np.isin(np.round(moments).astype(np.intp), kept)
    if np.count_nonzero(in_time) < 2:
        in_time = np.ones(STEPS, dtype=bool)
    lasting = np.diff(movement.reached, prepend=movement.reached[0])[kept]
    paths = _resample(_join(movement.paths, kept))
    return replace(
        movement,
        paths=paths - paths.mean(axis=0),
        limbs=_resample(movement.limbs[kept]),
        reached=np.interp(
            np.linspace(0, len(kept) - 1, STEPS), np.arange(len(kept)), np.cumsum(lasting)
        ),
        places=_resample(_join(movement.places, np.flatnonzero(in_time))),
    )


def _join(paths: FloatArray, kept: npt.NDArray[np.intp]) -> FloatArray:
    """Keep some steps of ``(N, L, 2)``; what follows a gap goes on where the gap begins."""
    joined = paths[kept].copy()
    for at in np.flatnonzero(np.diff(kept) > 1).tolist():
        gap = paths[kept[at + 1]] - paths[kept[at]]
        joined[at + 1 :] -= np.nan_to_num(gap)
    return joined


def _resample(values: FloatArray) -> FloatArray:
    """Resample ``(n, ...)`` equal steps to `STEPS` of them."""
    at = np.linspace(0, len(values) - 1, STEPS)
    before = np.minimum(at.astype(np.intp), len(values) - 2)
    share = (at - before).reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray(values[before] * (1 - share) + values[before + 1] * share)
