"""References: a language's demonstrations, and their movements in all allowed traversals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from app.recognition.features.motion import (
    SHARES,
    SIZE,
    Movement,
    build_movement,
    find_followed_landmarks,
    find_hands,
    list_arm_landmarks,
    uses_both_sides,
)
from app.recognition.features.traversals import AS_SHOWN, Traversal, list_traversals
from app.recognition.gestures.gesture import Gesture
from app.recognition.matching.dtw import BAND, OPEN_ENDS, DtwBatch, DtwReferences
from app.recognition.matching.dtw_kernel import compute_alignment_costs
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.motion_voters import DtwVoter, Path
from app.recognition.voters.registry import MOTION_VOTERS

MOST_DEMONSTRATIONS_TRAVERSED = 64
"""Number of demonstrations beyond which only demonstrated traversals are used: figures that differ
in direction only are then likely, and comparing all traversals would take seconds."""

MOST_COMPARED = 1
"""Number of traversals of each kind, of up to eight, that are compared by DTW: those nearest step
by step. The labels of 576 air-drawn digits, letters and commands are the same with 1, 2, 3, 4 or
all."""

REMEMBERED = 4
"""Languages whose references are cached: one and a few edited versions, each of up to ten
megabytes."""

REMEMBERED_TURNS = 16
"""Turned references that are cached: a dive has a few, each of up to ten megabytes."""

ROWS_AT_ONCE = 64
"""Rows compared at once, so that the costs of their steps fit the processor's cache."""

SMALLER = 0.8
"""Doublings by which a take may be smaller than its gesture at no cost: other people's right takes
differ by half a doubling at most, what people do between gestures is often smaller
(`benchmarks/studies/people.md`)."""

LEAST_SHARED = 0.05
"""Least cosine between the shares of two movements, so that none is infinitely far."""

Described = dict[str, FloatArray]
"""A movement's descriptors by voter's name, its `SHARES` and its `SIZE`; or those of R movements,
stacked along the first axis."""

_DTW = {
    voter.name: place for place, voter in enumerate(MOTION_VOTERS) if isinstance(voter, DtwVoter)
}
"""Indices of the voters that align movements by DTW."""


@dataclass(frozen=True, eq=False, kw_only=True)
class References:
    """All that a query is compared with: S demonstrations, and R rows of movements.

    Attributes
    ----------
    shown
        S gestures of one demonstration each: first those of the language, then their further
        demonstrations, then mirror images.
    owners
        ``(S,)``: index of each one's gesture in the language.
    demonstrations
        ``(S,)``: index of each one's demonstration in its gesture.
    mirrored
        ``(S,)``: whether it is a mirror image.
    turns
        ``(S,)`` degrees by which each is turned, positive to the body's own left.
    landmarks
        The landmarks that are followed in a query.
    rows
        ``(R,)`` index of each row's demonstration; held hand shapes and images have no row.
    traversals
        The traversal of each row; the first one of a demonstration is as it was shown.
    described
        Of each row, in its traversal.

    """

    shown: tuple[Gesture, ...]
    owners: npt.NDArray[np.intp]
    demonstrations: npt.NDArray[np.intp]
    mirrored: npt.NDArray[np.bool_]
    turns: npt.NDArray[np.intp]
    landmarks: tuple[str, ...]
    rows: npt.NDArray[np.intp]
    traversals: tuple[Traversal, ...]
    described: Described

    @classmethod
    def of(cls, gestures: Sequence[Gesture]) -> References:
        """Return the references of a language's gestures.

        Those of the last few languages are cached, because the same gestures occur again with other
        weights or limits.
        """
        return _build(tuple(gestures))

    @classmethod
    def of_movements(cls, movements: Sequence[Movement], landmarks: tuple[str, ...]) -> References:
        """Return references of movements as they are, each one a gesture of its own."""
        count = np.arange(len(movements))
        return cls(
            shown=(),
            owners=count,
            demonstrations=np.zeros_like(count),
            mirrored=np.zeros(len(count), dtype=bool),
            turns=np.zeros_like(count),
            landmarks=landmarks,
            rows=count,
            traversals=(AS_SHOWN,) * len(movements),
            described=_stack([describe_movement(each) for each in movements]),
        )

    def __len__(self) -> int:
        """Return R, the number of rows."""
        return len(self.rows)

    @cached_property
    def row_owners(self) -> npt.NDArray[np.intp]:
        """``(R,)``: index of each row's gesture in the language."""
        return self.owners[self.rows]

    @cached_property
    def as_shown(self) -> npt.NDArray[np.intp]:
        """Rows of the traversals as demonstrated."""
        return np.flatnonzero(np.diff(self.rows, prepend=-1))

    @cached_property
    def penalties(self) -> FloatArray:
        """``(R,)``: the factor on each row's distances."""
        return np.array([traversal.penalty for traversal in self.traversals])

    @cached_property
    def salient(self) -> dict[tuple[str, ...], npt.NDArray[np.intp]]:
        """The demonstrations that have rows, by their salient landmarks."""
        found: dict[tuple[str, ...], list[int]] = {}
        for index in np.unique(self.rows).tolist():
            found.setdefault(self.shown[index].salient, []).append(index)
        return {salient: np.array(members, dtype=np.intp) for salient, members in found.items()}

    @property
    def sees_arms(self) -> bool:
        """Whether the elbows are seen in any demonstration."""
        if not len(self):
            return False
        names = list_arm_landmarks(self.landmarks)
        elbows = [index for index, name in enumerate(names) if name.endswith("elbow")]
        moved = self.described[SHARES].reshape(len(self), 2, -1, 2)
        return bool(moved[:, :, elbows].any())

    def take(self, chosen: npt.NDArray[np.intp]) -> References:
        """Return references with some of the rows."""
        return replace(
            self,
            rows=self.rows[chosen],
            traversals=tuple(self.traversals[row] for row in chosen),
            described={name: values[chosen] for name, values in self.described.items()},
        )

    def turn(self, turns: Sequence[int]) -> References:
        """Return the same traversals of the demonstrations turned by some degrees each, ``(S,)``.

        Multiples of one step, because the last ones are cached; see `Trajectory.turn`.
        """
        return _turn(self, tuple(turns)) if any(turns) else self

    def correct(
        self, shares: FloatArray, chosen: npt.NDArray[np.intp] | slice = slice(None)
    ) -> FloatArray:
        """Compute the factors on the scores of a movement for how much each joint moves.

        The root of Jackknife's correction factor (Taranta et al. 2017): one over the cosines
        between the `Movement.shares` of both.

        Parameters
        ----------
        shares
            ``(2, 2 A)`` of the movement.
        chosen
            M of the rows.

        Returns
        -------
        ``(M,)`` >= 1.

        """
        alike = np.einsum("mij,ij->mi", self.described[SHARES][chosen], shares)
        return np.asarray(1.0 / np.sqrt(np.maximum(alike, LEAST_SHARED).prod(axis=1)))

    def measure_smallness(
        self, size: FloatArray, chosen: npt.NDArray[np.intp] | slice = slice(None)
    ) -> FloatArray:
        """Compute the factors on novelties of a movement for how much smaller it is.

        Parameters
        ----------
        size
            ``(2,)``: `Movement.size` of the movement; ``(N, 1, 2)`` of N movements.
        chosen
            M of the rows.

        Returns
        -------
        ``(M,)``, or ``(N, M)``, >= 1; 1 where either size is not known.

        """
        smaller = np.nan_to_num(self.described[SIZE][chosen] - size)
        return np.asarray(1 + 2 * np.maximum(smaller - SMALLER, 0.0).sum(axis=-1))

    def find_promising(self, path: FloatArray) -> npt.NDArray[np.intp]:
        """Return the rows that are compared with a query by DTW, in order.

        These are the demonstrated traversal of each demonstration and, of each kind (forwards,
        backwards, with exchanged sides), the `MOST_COMPARED` whose paths are nearest, step by step.

        Parameters
        ----------
        path
            The query's descriptor of voter ``path``.

        """
        (paths, squares), rows = self._flat_paths, self._rows_by_kind
        # The last element stands for missing rows.
        apart, chosen = np.empty(len(self) + 1), np.zeros(len(self) + 1, dtype=bool)
        apart[:-1], apart[-1] = squares - 2.0 * (paths @ path.ravel()), np.inf
        chosen[self.as_shown] = True
        nearest = apart.take(rows).argsort(axis=1, kind="stable")[:, :MOST_COMPARED]
        chosen[rows[np.arange(len(rows))[:, None], nearest]] = True
        return np.asarray(chosen[:-1].nonzero()[0])

    @cached_property
    def _flat_paths(self) -> tuple[FloatArray, FloatArray]:
        """Paths with all steps in a row, ``(R, N D)``, and the sums of their squares, ``(R,)``."""
        paths = self.described[Path.name].reshape(len(self), -1)
        return paths, np.vecdot(paths, paths)

    @cached_property
    def _rows_by_kind(self) -> npt.NDArray[np.intp]:
        """Rows of each demonstration's traversals of a kind, padded with R."""
        kinds: dict[tuple[int, bool, bool], list[int]] = {}
        for row, (index, traversal) in enumerate(
            zip(self.rows.tolist(), self.traversals, strict=True)
        ):
            kinds.setdefault((index, traversal.backward, traversal.exchanged), []).append(row)
        rows = np.full((len(kinds), max(map(len, kinds.values()), default=1)), len(self))
        for place, of_kind in enumerate(kinds.values()):
            rows[place, : len(of_kind)] = of_kind
        return rows

    @cached_property
    def own_distances(self) -> FloatArray:
        """``(V, S', R)``: distances of the first S' demonstrated traversals to all rows."""
        rows = self.as_shown[:MOST_DEMONSTRATIONS_TRAVERSED]
        own = np.empty((len(MOTION_VOTERS), len(rows), len(self)))
        for start in range(0, len(self), ROWS_AT_ONCE):
            block = self.take(np.arange(start, min(start + ROWS_AT_ONCE, len(self))))
            for index, row in enumerate(rows):
                query = {name: values[row] for name, values in self.described.items()}
                own[:, index, start : start + len(block)] = block.measure(query)
        return own

    @cached_property
    def own_corrections(self) -> FloatArray:
        """``(S', R)``: the corrections of the first S' demonstrated traversals."""
        rows = self.as_shown[:MOST_DEMONSTRATIONS_TRAVERSED]
        shares = self.described[SHARES][rows]
        return np.array([self.correct(each) for each in shares]).reshape(len(rows), len(self))

    @cached_property
    def _dtw_batch(self) -> DtwBatch:
        """The references of the DTW voters."""
        return DtwBatch(
            tuple(DtwReferences(self.described[name], BAND, OPEN_ENDS) for name in _DTW)
        )

    def measure(self, query: Described, chosen: npt.NDArray[np.intp] | None = None) -> FloatArray:
        """Compute the voters' distances ``(V, M)`` of a query to M of the rows; all when not given.

        The DTW voters are computed together, which costs hardly more than one.
        """
        costs = self._dtw_batch.step_costs([query[name] for name in _DTW], chosen)
        found = np.empty((len(MOTION_VOTERS), costs.shape[-1]))
        found[[*_DTW.values()]] = compute_alignment_costs(costs, len(query[Path.name]), BAND)
        for place, voter in enumerate(MOTION_VOTERS):
            if voter.name not in _DTW:
                described = self.described[voter.name]
                described = described if chosen is None else described.take(chosen, axis=0)
                found[place] = voter.distances(query[voter.name], described)
        return found


def find_nearest(
    scores: FloatArray, owners: npt.NDArray[np.intp], count: int
) -> npt.NDArray[np.intp]:
    """Return which of M scores is the smallest of each gesture.

    Parameters
    ----------
    scores
        ``(M,)``, infinite where not comparable.
    owners
        ``(M,)``: index of each one's gesture in the language.
    count
        G, the number of gestures.

    Returns
    -------
    ``(G,)`` indices of scores, of equals the first; -1 for a gesture without a finite one.

    """
    # The best is written last.
    order = np.argsort(scores, kind="stable")[::-1]
    order = order[np.isfinite(scores[order])]
    nearest = np.full(count, -1, dtype=np.intp)
    nearest[owners[order]] = order
    return nearest


def describe_movement(movement: Movement) -> Described:
    """Describe a movement for all motion voters."""
    described = {voter.name: voter.describe(movement) for voter in MOTION_VOTERS}
    return described | {SHARES: movement.shares, SIZE: movement.size}


def describe_query(trajectory: Trajectory, landmarks: tuple[str, ...]) -> Described:
    """Describe the movement of a query, cached."""
    return trajectory.compute_once(
        ("movement", landmarks), lambda: describe_movement(build_movement(trajectory, landmarks))
    )


def _describe_traversals(
    trajectory: Trajectory, landmarks: tuple[str, ...], traversals: Sequence[Traversal]
) -> Described:
    """Describe a demonstration in some traversals, cached."""

    def compute() -> Described:
        shown = _build_once(trajectory, landmarks)
        return _stack([describe_movement(each.of(shown, landmarks)) for each in traversals])

    ways = tuple((each.order.tobytes(), each.exchanged) for each in traversals)
    return trajectory.compute_once(("traversals", landmarks, ways), compute)


def _build_once(trajectory: Trajectory, landmarks: tuple[str, ...]) -> Movement:
    return trajectory.compute_once(
        ("shown", landmarks), lambda: build_movement(trajectory, landmarks)
    )


def _stack(described: Sequence[Described]) -> Described:
    return {name: np.array([each[name] for each in described]) for name in described[0]}


def _list_traversals(
    shown: Gesture, landmarks: tuple[str, ...], *, every: bool
) -> tuple[Traversal, ...]:
    """Return the traversals of one demonstration that its switches allow, cached."""
    switches, trajectory = shown.switches, shown.trajectory
    if trajectory is None or len(trajectory) < 2 or not shown.salient:
        return ()
    if not every:
        return (AS_SHOWN,)
    hands, both_ways = find_hands(shown.salient), switches.direction != "on"
    either_way = switches.direction == "off"
    either_side = switches.mirror == "auto" and uses_both_sides(shown.salient)
    return trajectory.compute_once(
        ("ways", landmarks, hands, both_ways, either_way, either_side),
        lambda: list_traversals(
            _build_once(trajectory, landmarks),
            hands=hands,
            both_ways=both_ways,
            either_way=either_way,
            either_side=either_side,
        ),
    )


@lru_cache(maxsize=REMEMBERED)
def _build(gestures: tuple[Gesture, ...]) -> References:
    every = [
        (number, owner, each)
        for owner, gesture in enumerate(gestures)
        for number, each in enumerate(gesture.single_demonstrations())
    ]
    every.sort(key=lambda each: each[0] > 0)
    images = [
        (number, owner, each.mirror())
        for number, owner, each in every
        if each.switches.mirror == "on" and each.trajectory is not None
    ]
    numbers, owners, shown = zip(*every, *images, strict=True)
    landmarks = find_followed_landmarks([each.salient for each in shown])
    traversals = [
        _list_traversals(each, landmarks, every=len(shown) <= MOST_DEMONSTRATIONS_TRAVERSED)
        for each in shown
    ]
    described = [
        _describe_traversals(each.trajectory, landmarks, ways)
        for each, ways in zip(shown, traversals, strict=True)
        if ways and each.trajectory is not None
    ]
    names = (*(voter.name for voter in MOTION_VOTERS), SHARES, SIZE)
    return References(
        shown=shown,
        owners=np.array(owners, dtype=np.intp),
        demonstrations=np.array(numbers, dtype=np.intp),
        mirrored=np.arange(len(shown)) >= len(every),
        turns=np.zeros(len(shown), dtype=np.intp),
        landmarks=landmarks,
        rows=np.repeat(np.arange(len(shown)), [len(ways) for ways in traversals]),
        traversals=tuple(way for ways in traversals for way in ways),
        described={
            name: np.concatenate([each[name] for each in described] or [np.empty(0)])
            for name in names
        },
    )


@lru_cache(maxsize=REMEMBERED_TURNS)
def _turn(references: References, turns: tuple[int, ...]) -> References:
    """Return demonstrations whose bodies are turned by degrees about the vertical, remembered."""
    described = {name: values.copy() for name, values in references.described.items()}
    for index in np.unique(references.rows).tolist():
        trajectory = references.shown[index].trajectory
        if trajectory is None or not turns[index]:
            continue
        rows = np.flatnonzero(references.rows == index)
        ways = [references.traversals[row] for row in rows]
        turned = trajectory.turn_once(turns[index])
        for name, values in _describe_traversals(turned, references.landmarks, ways).items():
            described[name][rows] = values
    return replace(references, turns=np.array(turns, dtype=np.intp), described=described)
