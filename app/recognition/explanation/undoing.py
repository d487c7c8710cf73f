"""Undoing: changes of a take or a demonstration, and how much nearer each brings the two.

A cause is tested by its inverse: the take is mirrored back, reversed, turned upright, cut, freed
of the moments at which keypoints jumped, or the demonstration is cut, and both are compared again
with the weights and the limit of the language.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
import numpy.typing as npt

from app.recognition.decision.fused_vote import FusedVote
from app.recognition.decision.fusion import fuse
from app.recognition.decision.references import SMALLER, Described, References, describe_movement
from app.recognition.features.motion import (
    SHARES,
    SIZE,
    STEPS,
    Movement,
    build_movement,
    find_hands,
)
from app.recognition.features.traversals import AS_SHOWN, Traversal, list_traversals
from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.jumps import find_other_body, find_unsteady
from app.recognition.voters.registry import MOTION_VOTERS, VOTER_NAMES

CUTS = tuple(range(3, STEPS // 2 + 1, 2))
"""Steps of 32 that may be missing or added: from a tenth to a half, beyond which the rest is no
longer most of the gesture."""

END_CUTS = tuple(range(1, 10, 2))
"""Steps of 32 that are cut off either end of a demonstration that holds the ways from and to the
salutes."""

FEWEST_STEPS = 8
"""Least steps of 32 that a cut leaves."""

TURNED_AWAY = 40.0
"""Least degrees between two measured facings that count as turned away; pose models err by 10."""


@dataclass(frozen=True, eq=False)
class Undone:
    """A take and a demonstration after one change.

    Attributes
    ----------
    kind
        The kind of cause that the change would undo, see `causes.CauseKind`.
    size
        In [0, 1]: how much the change takes away; 0 for one that keeps all of both.
    novelty
        Distance of the two after it, over the language's limit; above 1 is rejected.
    start, end
        Seconds after the beginning of the take of what differs; None: all of it.
    where
        Which part is missing or added: ``start``, ``middle`` or ``end``; empty for other kinds.
    cut
        Shares of the demonstration cut off its start and its end.

    """

    kind: str
    size: float
    novelty: float
    start: float | None = None
    end: float | None = None
    where: str = ""
    cut: tuple[float, float] = (0.0, 0.0)


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
        return tuple(each.of(whole, self._landmarks) for each in (self._forwards(starts), *starts))

    def _forwards(self, starts: Sequence[Traversal]) -> Traversal:
        """Return the nearest traversal, or the demonstrated one where that goes backwards."""
        return starts[0] if self.traversal.backward else self.traversal

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

    @property
    def as_shown(self) -> Movement:
        """The demonstration as it was shown."""
        return self.shown[1]

    def measure_cut(self, cut: tuple[float, float]) -> float:
        """Return the novelty with shares of the demonstration cut off its start and its end."""
        return self.measure(self.query, [_cut_ends(self.as_shown, cut)])

    def locate_cut(self, cut: tuple[float, float]) -> tuple[float, float]:
        """Return the seconds of the demonstration's clock between which a cut keeps it."""
        before, after = _count_steps(cut)
        reached = self.as_shown.reached
        return float(reached[before]), float(reached[STEPS - 1 - after])

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

    def undo_all(self, raw: Trajectory) -> Iterator[Undone]:
        """Yield every change with the novelty after it.

        Parameters
        ----------
        raw
            The take before it was repaired and condensed, at the moments of its frames.

        """
        yield from self._turn_over()
        yield from self._exchange_arms()
        yield from self._face_camera()
        yield from self._enlarge()
        yield from self._cut_demonstration()
        yield from self._cut_take()
        yield from self._drop_moments(raw)

    def _turn_over(self) -> Iterator[Undone]:
        """Reverse the take, mirror it in its place, or turn it upright."""
        for kind, way in (
            ("mirrored", (-1, 1)),
            ("upside_down", (1, -1)),
            ("upside_down", (-1, -1)),
        ):
            yield Undone(kind, 0.0, self.measure(flip(self.query, way), self.shown))
        backwards = self.query.reorder(AS_SHOWN.order[::-1])
        yield Undone("reversed", 0.0, self.measure(backwards, self.shown))

    def _exchange_arms(self) -> Iterator[Undone]:
        """Show the take with the other arm, as its mirror image or not."""
        other = build_movement(self._query.mirror(), self._landmarks)
        for movement in (other, flip(other, (-1, 1))):
            yield Undone("other_arm", 0.0, self.measure(movement, self.shown))

    def _face_camera(self) -> Iterator[Undone]:
        """Turn the take to the facing of the demonstration, where both are measured."""
        here, there = self._query.facing, self._trajectory.facing
        if here is None or there is None or abs(here - there) < TURNED_AWAY:
            return
        turned = build_movement(self._query.turn(there - here), self._landmarks)
        yield Undone("turned_away", 0.0, self.measure(turned, self.shown))

    def _enlarge(self) -> Iterator[Undone]:
        """Show the take as large as the demonstration."""
        smaller = self.shown[0].size - self.query.size
        if np.nanmax(np.nan_to_num(smaller)) > SMALLER:
            larger = float(2.0 ** np.nanmax(smaller))
            mean = self.query.places.mean(axis=0)
            places = mean + larger * (self.query.places - mean)
            movement = replace(self.query, places=places)
            yield Undone("too_small", 0.0, self.measure(movement, self.shown))

    def _cut_demonstration(self) -> Iterator[Undone]:
        """Leave out a part of the demonstration: an end of it, both ends, or its middle."""
        shown, end = self.shown[0], self.query.duration
        moments = {"start": 0.0, "end": end}
        for where in ("start", "end"):
            for steps in CUTS:
                cut = _cut_end(shown, steps, where)
                kind = "begun_late" if where == "start" else "ended_early"
                novelty = self.measure(self.query, [cut])
                at = moments[where]
                yield Undone(kind, steps / STEPS, novelty, at, at, where, _shares(steps, where))
        for first, steps in _list_middles():
            novelty = self.measure(self.query, [_cut_middle(shown, first, steps)])
            at = float(self.query.reached[first])
            yield Undone("part_missing", steps / STEPS, novelty, at, at, "middle")
        for before in END_CUTS:
            for after in END_CUTS:
                shares = (before / STEPS, after / STEPS)
                novelty = self.measure_cut(shares)
                yield Undone("demonstration", sum(shares), novelty, cut=shares)

    def _cut_take(self) -> Iterator[Undone]:
        """Leave out a part of the take: an end of it, or its middle."""
        reached = self.query.reached
        for where in ("start", "end"):
            for steps in CUTS:
                novelty = self.measure(_cut_end(self.query, steps, where), self.shown)
                span = (0, steps) if where == "start" else (STEPS - 1 - steps, STEPS - 1)
                start, end = (float(reached[step]) for step in span)
                yield Undone("part_added", steps / STEPS, novelty, start, end, where)
        for first, steps in _list_middles():
            novelty = self.measure(_cut_middle(self.query, first, steps), self.shown)
            start, end = float(reached[first]), float(reached[first + steps])
            yield Undone("part_added", steps / STEPS, novelty, start, end, "middle")

    def _drop_moments(self, raw: Trajectory) -> Iterator[Undone]:
        """Leave out the moments at which keypoints jumped, or another body was seen."""
        finders: dict[str, Callable[[Trajectory], npt.NDArray[np.bool_]]] = {
            "keypoints_jumped": lambda each: find_unsteady(each, self._salient),
            "other_person": find_other_body,
        }
        for kind, find in finders.items():
            bad = find(raw)
            if not bad.any() or np.count_nonzero(~bad) < FEWEST_STEPS:
                continue
            kept = replace(
                raw,
                xy=raw.xy[~bad],
                time=raw.time[~bad],
                depth=None if raw.depth is None else raw.depth[~bad],
            )
            novelty = self.measure(build_movement(condense(kept), self._landmarks), self.shown)
            times = raw.time[bad]
            yield Undone(kind, float(bad.mean()), novelty, float(times[0]), float(times[-1]))


def find_better_range(comparisons: Sequence[Comparison]) -> tuple[float, float] | None:
    """Return the seconds of a demonstration to keep so that takes are nearest to it.

    Parameters
    ----------
    comparisons
        Of takes with this demonstration, at least one.

    Returns
    -------
    By the median take; of cuts that help as much the smaller one. None where none helps.

    """
    best, chosen = float(np.median([each.base for each in comparisons])), None
    for before, after in product((0, *END_CUTS), repeat=2):
        cut = (before / STEPS, after / STEPS)
        typical = float(np.median([each.measure_cut(cut) for each in comparisons]))
        if (worth := typical + sum(cut) / 4) < best:
            best, chosen = worth, comparisons[0].locate_cut(cut)
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


def _count_steps(cut: tuple[float, float]) -> tuple[int, int]:
    """Return the steps that shares of a movement are."""
    return round(cut[0] * STEPS), round(cut[1] * STEPS)


def _cut_ends(movement: Movement, cut: tuple[float, float]) -> Movement:
    before, after = _count_steps(cut)
    return _keep(movement, np.arange(before, STEPS - after)) if before or after else movement


def _shares(steps: int, where: str) -> tuple[float, float]:
    share = steps / STEPS
    return (share, 0.0) if where == "start" else (0.0, share)


def _list_middles() -> Iterator[tuple[int, int]]:
    """Yield first step and number of steps of the parts in the middle that may be left out."""
    for steps in CUTS:
        for first in range(STEPS // 8, STEPS - STEPS // 8 - steps, 3):
            yield first, steps


def _cut_end(movement: Movement, steps: int, where: str) -> Movement:
    """Leave out steps at the start or the end."""
    kept = np.arange(steps, STEPS) if where == "start" else np.arange(STEPS - steps)
    return _keep(movement, kept)


def _cut_middle(movement: Movement, first: int, steps: int) -> Movement:
    """Leave out steps in the middle, and join what is before and after them."""
    kept = np.r_[np.arange(first + 1), np.arange(first + steps, STEPS)]
    return _keep(movement, kept)


def _keep(movement: Movement, kept: npt.NDArray[np.intp]) -> Movement:
    """Keep some of a movement's steps, joined, and resample them to `STEPS`."""
    shares = movement.reached / max(float(movement.reached[-1]), 1e-9)
    moments = np.interp(np.linspace(0, 1, STEPS), shares, np.arange(STEPS))
    in_time = np.isin(np.round(moments).astype(np.intp), kept)
    if np.count_nonzero(in_time) < 2:
        in_time = np.ones(STEPS, dtype=bool)
    lasting = np.diff(movement.reached, prepend=movement.reached[0])[kept]
    return replace(
        movement,
        paths=_centre(_resample(_join(movement.paths, kept))),
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


def _centre(paths: FloatArray) -> FloatArray:
    return np.asarray(paths - paths.mean(axis=0))


def _resample(values: FloatArray) -> FloatArray:
    """Resample ``(n, ...)`` equal steps to `STEPS` of them."""
    at = np.linspace(0, len(values) - 1, STEPS)
    before = np.minimum(at.astype(np.intp), len(values) - 2)
    share = (at - before).reshape(-1, *(1,) * (values.ndim - 1))
    return np.asarray(values[before] * (1 - share) + values[before + 1] * share)
