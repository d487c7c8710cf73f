"""Motion references: the gestures of a language as movements, in all allowed traversals."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from app.recognition.decision.fusion import fuse
from app.recognition.decision.shown_gesture import ShownGesture, describe_traversals
from app.recognition.features.motion import (
    SHARES,
    SIZE,
    build_movement,
    find_followed_landmarks,
    list_arm_landmarks,
)
from app.recognition.features.traversals import Traversal
from app.recognition.gestures.gesture import Gesture
from app.recognition.matching.dtw import BAND, OPEN_ENDS, DtwBatch, DtwReferences
from app.recognition.matching.dtw_kernel import compute_alignment_costs
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.motion_voters import DtwVoter, Path, Tempo
from app.recognition.voters.registry import MOTION_VOTERS

SAME_FIGURE = 0.25
"""Score below which two gestures are the same figure: that of two people's takes of one gesture. On
air-drawn digits and commands the accuracy falls beyond 0.4, when useful traversals are lost."""

TURNED = 0.2
"""Ratio of backward to forward score below which two figures are one in opposite directions, such
as two swipes."""

CLEARANCE = 0.63
"""Largest ratio of backward to forward score at which a direction matters: two circles with
different starting points are about as near either way."""

CLEARLY_SLOWER = 0.8
"""Doublings of the duration from which two gestures differ in tempo: 1.75 times as long. One
person's takes of a gesture differ by a quarter of a doubling, two people's by half."""

MAX_GESTURES_TRAVERSED = 64
"""Number of gestures beyond which only demonstrated traversals are used: figures that differ in
direction only are then likely, and comparing all traversals would take seconds."""

MOST_COMPARED = 1
"""Number of traversals of each kind, of up to eight, that are compared by DTW: those nearest step
by step. The labels of 576 air-drawn digits, letters and commands are the same with 1, 2, 3, 4 or
all."""

REMEMBERED = 4
"""Languages whose references are cached: one and a few edited versions, each of up to ten
megabytes."""

ROWS_AT_ONCE = 64
"""Rows compared at once, so that the costs of their steps fit the processor's cache."""

_DTW = {
    voter.name: place for place, voter in enumerate(MOTION_VOTERS) if isinstance(voter, DtwVoter)
}
"""Indices of the voters that align movements by DTW."""

_OTHERS = {
    place: voter for place, voter in enumerate(MOTION_VOTERS) if not isinstance(voter, DtwVoter)
}

_TEMPO = [voter.name for voter in MOTION_VOTERS].index(Tempo.name)

SMALLER = 0.8
"""Doublings by which a take may be smaller than its gesture at no cost: other people's right takes
differ by half a doubling at most, what people do between gestures is often smaller
(`benchmarks/studies/people.md`)."""

LEAST_SHARED = 0.05
"""Least cosine between the shares of two movements, so that none is infinitely far."""


@dataclass(frozen=True, eq=False)
class NearestTraversals:
    """The traversals of G gestures that are nearest to a query.

    Attributes
    ----------
    rows
        ``(G,)``: row of the references; -1 for a gesture without demonstration.
    distances
        ``(V, G)`` to these traversals, infinite for a gesture without demonstration.
    corrections
        ``(G,)``: see `MotionReferences.correct`; 1 for a gesture without demonstration.

    """

    rows: npt.NDArray[np.intp]
    distances: FloatArray
    corrections: FloatArray


@dataclass(frozen=True, eq=False)
class MotionReferences:
    """Motion references of a language: R rows, each a gesture in one traversal.

    Attributes
    ----------
    landmarks
        The landmarks used of a query.
    gestures
        ``(R,)`` index of each row's gesture in the language.
    traversals
        The traversal of each row.
    descriptors
        By voter's name, ``(R, ...)``, and the `SHARES` and `SIZE`.

    """

    landmarks: tuple[str, ...]
    gestures: npt.NDArray[np.intp]
    traversals: tuple[Traversal, ...]
    descriptors: dict[str, FloatArray]

    @classmethod
    def of(cls, gestures: Sequence[Gesture]) -> MotionReferences:
        """Return the references of all gestures with a demonstration, in all traversals.

        References of the last few languages are cached, because the same gestures occur again with
        other drawings, weights or limits.
        """
        return _build_cached(tuple(ShownGesture.of(gesture) for gesture in gestures))

    @classmethod
    def of_shown(cls, gestures: Sequence[ShownGesture]) -> MotionReferences:
        """Compute the references without cache."""
        landmarks = find_followed_landmarks([gesture.salient for gesture in gestures])
        every = len(gestures) <= MAX_GESTURES_TRAVERSED
        described = {
            index: gesture.describe(landmarks, every=every)
            for index, gesture in enumerate(gestures)
            if gesture.trajectory is not None and len(gesture.trajectory) > 1 and gesture.salient
        }
        sizes = np.array([len(each.traversals) for each in described.values()], dtype=np.intp)
        return cls(
            landmarks,
            np.repeat(np.array([*described], dtype=np.intp), sizes),
            tuple(traversal for each in described.values() for traversal in each.traversals),
            {
                name: np.concatenate(
                    [each.descriptors[name] for each in described.values()] or [np.empty(0)]
                )
                for name in (*(voter.name for voter in MOTION_VOTERS), SHARES, SIZE)
            },
        )

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.gestures)

    @cached_property
    def as_shown(self) -> npt.NDArray[np.intp]:
        """Rows of the gestures' demonstrated traversals."""
        return np.flatnonzero(self._shown)

    def take(self, rows: npt.NDArray[np.intp]) -> MotionReferences:
        """Return references of some of the rows."""
        return MotionReferences(
            self.landmarks,
            self.gestures[rows],
            tuple(self.traversals[row] for row in rows),
            {name: values[rows] for name, values in self.descriptors.items()},
        )

    def turn(self, gestures: Sequence[Gesture], turns: Sequence[int]) -> MotionReferences:
        """Return the same traversals of the demonstrations turned by some degrees each.

        Parameters
        ----------
        gestures
            Those of the references, of one demonstration each.
        turns
            Degrees, see `Trajectory.turn`; multiples of one step, because all are cached.

        """
        descriptors = {name: values.copy() for name, values in self.descriptors.items()}
        for index in np.unique(self.gestures):
            seen = gestures[index].trajectory
            if seen is None or not turns[index]:
                continue
            rows = np.flatnonzero(self.gestures == index)
            turned = seen.turn_once(turns[index])
            described = _describe_turned(
                turned, self.landmarks, [self.traversals[row] for row in rows]
            )
            for name, values in described.items():
                descriptors[name][rows] = values
        return MotionReferences(self.landmarks, self.gestures, self.traversals, descriptors)

    def correct(self, shares: FloatArray, rows: npt.NDArray[np.intp] | None = None) -> FloatArray:
        """Compute the factors on the scores of a movement for how much each joint moves.

        The root of Jackknife's correction factor (Taranta et al. 2017): one over the cosines
        between the `Movement.shares` of both.

        Parameters
        ----------
        shares
            ``(2, 2 A)`` of the movement.
        rows
            Indices of M of the rows; all when not given.

        Returns
        -------
        ``(M,)`` >= 1.

        """
        shown = self.descriptors[SHARES]
        alike = np.einsum("mij,ij->mi", shown if rows is None else shown[rows], shares)
        return np.asarray(1.0 / np.sqrt(np.maximum(alike, LEAST_SHARED).prod(axis=1)))

    def measure_smallness(self, size: FloatArray, rows: npt.NDArray[np.intp]) -> FloatArray:
        """Compute the factors on novelties of a movement for how much smaller it is.

        Parameters
        ----------
        size
            ``(2,)``: `Movement.size` of the movement; ``(S, 1, 2)`` of S movements.
        rows
            Indices of M of the rows.

        Returns
        -------
        ``(M,)``, or ``(S, M)``, >= 1; 1 where either size is not known.

        """
        smaller = np.nan_to_num(self.descriptors[SIZE][rows] - size)
        return np.asarray(1 + 2 * np.maximum(smaller - SMALLER, 0.0).sum(axis=-1))

    @property
    def sees_arms(self) -> bool:
        """Whether the elbows are seen in any demonstration."""
        if not len(self):
            return False
        names = list_arm_landmarks(self.landmarks)
        elbows = [index for index, name in enumerate(names) if name.endswith("elbow")]
        moved = self.descriptors[SHARES].reshape(len(self), 2, -1, 2)
        return bool(moved[:, :, elbows].any())

    def find_promising(self, path: FloatArray) -> npt.NDArray[np.intp]:
        """Return the traversals that are compared with a query by DTW.

        These are the demonstrated traversal of each gesture and, of each kind (forwards, backwards,
        with exchanged sides), the `MOST_COMPARED` whose paths are nearest, step by step.

        Parameters
        ----------
        path
            The query's descriptor of voter ``path``.

        Returns
        -------
        Indices of rows, in order.

        """
        (paths, squares), rows = self._flat_paths, self._rows_by_kind
        # The last element stands for missing rows.
        apart, chosen = np.empty(len(self) + 1), np.zeros(len(self) + 1, dtype=bool)
        apart[:-1], apart[-1] = squares - 2.0 * (paths @ path.ravel()), np.inf
        chosen[:-1] = self._shown
        nearest = apart.take(rows).argsort(axis=1, kind="stable")[:, :MOST_COMPARED]
        chosen[rows[np.arange(len(rows))[:, None], nearest]] = True
        return np.asarray(chosen[:-1].nonzero()[0])

    @cached_property
    def _flat_paths(self) -> tuple[FloatArray, FloatArray]:
        """Paths with all steps in a row, ``(R, N D)``, and the sums of their squares, ``(R,)``."""
        paths = self.descriptors[Path.name].reshape(len(self), -1)
        return paths, np.vecdot(paths, paths)

    @cached_property
    def _shown(self) -> npt.NDArray[np.bool_]:
        """``(R,)``: whether a row is a demonstrated traversal."""
        return np.asarray(np.diff(self.gestures, prepend=-1) != 0)

    @cached_property
    def _rows_by_kind(self) -> npt.NDArray[np.intp]:
        """Rows of each gesture's traversals of a kind, padded with R."""
        kinds: dict[tuple[int, bool, bool], list[int]] = {}
        for row, (gesture, traversal) in enumerate(
            zip(self.gestures, self.traversals, strict=True)
        ):
            kind = (int(gesture), traversal.backward, traversal.exchanged)
            kinds.setdefault(kind, []).append(row)
        rows = np.full((len(kinds), max(map(len, kinds.values()), default=1)), len(self))
        for index, of_kind in enumerate(kinds.values()):
            rows[index, : len(of_kind)] = of_kind
        return rows

    @cached_property
    def _dtw_batch(self) -> DtwBatch:
        """The references of the DTW voters."""
        return DtwBatch(
            tuple(DtwReferences(self.descriptors[name], BAND, OPEN_ENDS) for name in _DTW)
        )

    @cached_property
    def penalties(self) -> FloatArray:
        """``(R,)``: the factor on each row's distances."""
        return np.array([traversal.penalty for traversal in self.traversals])

    @cached_property
    def own_corrections(self) -> FloatArray:
        """``(S, R)``: the corrections of the first S demonstrated traversals."""
        rows = self.as_shown[:MAX_GESTURES_TRAVERSED].tolist()
        return np.array([self.correct(self.descriptors[SHARES][row]) for row in rows]).reshape(
            len(rows), len(self)
        )

    @cached_property
    def own_distances(self) -> FloatArray:
        """``(V, S, R)``: distances of the first S demonstrated traversals to all rows."""
        rows = self.as_shown[:MAX_GESTURES_TRAVERSED]
        own = np.empty((len(MOTION_VOTERS), len(rows), len(self)))
        for start in range(0, len(self), ROWS_AT_ONCE):
            block = self.take(np.arange(start, min(start + ROWS_AT_ONCE, len(self))))
            for index, row in enumerate(rows):
                query = {name: values[row] for name, values in self.descriptors.items()}
                own[:, index, start : start + len(block)] = block._measure(query)
        return own

    def _measure(
        self, query: dict[str, FloatArray], rows: npt.NDArray[np.intp] | None = None
    ) -> FloatArray:
        """Compute the distances of a query to M of the rows, all when not given: ``(V, M)``.

        The DTW voters are computed together, which costs hardly more than one.
        """
        chosen = np.arange(len(self)) if rows is None else rows
        costs = self._dtw_batch.step_costs([query[name] for name in _DTW], rows)
        found = np.empty((len(MOTION_VOTERS), len(chosen)))
        found[[*_DTW.values()]] = compute_alignment_costs(costs, len(query[Path.name]), BAND)
        for place, other in _OTHERS.items():
            described = self.descriptors[other.name].take(chosen, axis=0)
            found[place] = other.distances(query[other.name], described)
        return found

    def find_nearest(
        self, query: dict[str, FloatArray], weights: FloatArray, between: FloatArray, count: int
    ) -> NearestTraversals:
        """Return for each gesture the traversal that is nearest to a query.

        Parameters
        ----------
        query
            Descriptors by voter's name.
        weights, between
            Of the voters, see `fusion.weigh_voters`.
        count
            G, the number of gestures in the language.

        """
        compared = self.find_promising(query[Path.name])
        measured = self._measure(query, compared)
        corrections = self.correct(query[SHARES], compared)
        scores = fuse(measured, weights, between) * self.penalties[compared] * corrections
        # The best is written last; of equals the first row, the demonstrated traversal.
        order = np.argsort(scores, kind="stable")[::-1]
        chosen = np.full(count, -1, dtype=np.intp)
        chosen[self.gestures[compared[order]]] = order
        found = chosen >= 0
        if found.all():
            return NearestTraversals(
                compared.take(chosen), measured.take(chosen, axis=1), corrections.take(chosen)
            )
        distances = np.full((len(MOTION_VOTERS), count), np.inf)
        distances[:, found] = measured[:, chosen[found]]
        corrected = np.ones(count)
        corrected[found] = corrections[chosen[found]]
        return NearestTraversals(np.where(found, compared[chosen], -1), distances, corrected)


def _describe_turned(
    trajectory: Trajectory, landmarks: tuple[str, ...], traversals: Sequence[Traversal]
) -> dict[str, FloatArray]:
    """Return the descriptors ``(R, ...)`` by voter's name, cached."""

    def compute() -> dict[str, FloatArray]:
        return describe_traversals(build_movement(trajectory, landmarks), traversals, landmarks)

    ways = tuple((each.order.tobytes(), each.exchanged) for each in traversals)
    return trajectory.compute_once(("traversals", landmarks, ways), compute)


@lru_cache(maxsize=REMEMBERED)
def _build_cached(gestures: tuple[ShownGesture, ...]) -> MotionReferences:
    return MotionReferences.of_shown(gestures)


def find_tempo_dependent(
    references: MotionReferences,
    scores: FloatArray,
    gestures: Sequence[Gesture],
    owners: npt.NDArray[np.intp],
) -> npt.NDArray[np.bool_]:
    """Return ``(S,)``: the references whose tempo counts, by their switch or automatically.

    The tempo counts automatically for two gestures that differ in duration only. Parameters as for
    `find_unambiguous_traversals`; `gestures` are those of the references, S in number.
    """
    shown = references.as_shown
    doublings = references.own_distances[_TEMPO][:, shown]
    owner = owners[references.gestures[shown]]
    twins = (
        (scores[:, shown] < SAME_FIGURE) & (doublings > CLEARLY_SLOWER) & (owner[:, None] != owner)
    )
    needed = np.zeros(len(gestures), dtype=bool)
    needed[references.gestures[shown]] = twins.any(axis=0)
    for index, gesture in enumerate(gestures):
        if gesture.switches.tempo != "auto":
            needed[index] = gesture.switches.tempo == "on"
    return needed


def describe_movement(trajectory: Trajectory, landmarks: Sequence[str]) -> dict[str, FloatArray]:
    """Return the descriptors of a query by voter's name, cached."""

    def compute() -> dict[str, FloatArray]:
        seen = build_movement(trajectory, landmarks)
        described = {voter.name: voter.describe(seen) for voter in MOTION_VOTERS}
        return described | {SHARES: seen.shares, SIZE: seen.size}

    return trajectory.compute_once(("movement", tuple(landmarks)), compute)


def find_unambiguous_traversals(
    references: MotionReferences,
    scores: FloatArray,
    owners: npt.NDArray[np.intp],
    free: Collection[int] = (),
) -> npt.NDArray[np.intp]:
    """Return the rows of the traversals by which no gesture is confused with another one.

    Backward traversals are left out when another gesture is the same figure in the opposite
    direction: for some starting points, the score with one of them reversed is below
    `SAME_FIGURE` or `TURNED` times the forward score, and also below `CLEARANCE` times the forward
    score. Exchanged sides are left out by the same rule.

    Parameters
    ----------
    references
        In all traversals.
    scores
        ``(S, R)`` of the demonstrated traversals for all rows, without penalties.
    owners
        ``(S,)``: index in the language of each reference's gesture.
    free
        Indices of the gestures whose direction never counts.

    """
    labels = owners[references.gestures]
    shown = references.as_shown
    same = labels[shown][:, None] == labels[None]
    scores = np.where(same, np.inf, scores)
    backward = np.array([traversal.backward for traversal in references.traversals], dtype=bool)
    exchanged = np.array([traversal.exchanged for traversal in references.traversals], dtype=bool)
    keep = np.ones(len(references), dtype=bool)
    for gesture in np.unique(labels):
        rows = labels == gesture
        plain = scores[:, rows & ~backward & ~exchanged].min(axis=1)
        for otherwise, matters in ((backward, gesture not in free), (exchanged, True)):
            turned = scores[:, rows & otherwise].min(axis=1, initial=np.inf)
            alike = np.maximum(SAME_FIGURE, TURNED * plain)
            if matters and ((turned < alike) & (turned < CLEARANCE * plain)).any():
                keep[rows & otherwise] = False
    return np.flatnonzero(keep)
