"""The gestures of a language as movements, in every reading that the language leaves open."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import numpy.typing as npt

from app.recognition.elastic import ElasticReferences, ElasticViews, alignment_costs
from app.recognition.fusion import fused
from app.recognition.gesture import Gesture
from app.recognition.movement import (
    followed_landmarks,
    movement,
)
from app.recognition.poses import FloatArray
from app.recognition.readings import Reading
from app.recognition.shown_gesture import ShownGesture
from app.recognition.step_distances import StepReferences
from app.recognition.trajectory import Trajectory
from app.recognition.voters.motion import BAND, MOTION_VOTERS, ElasticVoter, UnorderedVoter

SAME_FIGURE = 0.12
"""Score below which two gestures are the same figure, where 1 is two gestures of the language: as
far as two people's takes of one gesture lie apart. On air-drawn digits and commands the accuracy
is the same from 0.05 to 0.1 and falls beyond 0.2, when useful readings are lost."""

TURNED = 0.1
"""Share of the forward distance that a figure turned round lies within, however far: two swipes to
either side, one more curved than the other. Of the same person's, 0.03 is rarely exceeded; pairs
of other figures on air-drawn digits and commands lie above 0.13."""

CLEARANCE = 0.4
"""How much nearer a figure must be backwards than forwards for its direction to matter: two
circles that begin at different places are about as near to each other either way."""

CLEARLY_SLOWER = 0.8
"""Doublings of the duration between two gestures from which their tempo is told apart: 1.75 times
as long. One person's takes of a gesture differ by a quarter of a doubling, two people's by half."""

MAX_GESTURES_READ_OTHERWISE = 64
"""Gestures beyond which a language takes every gesture as shown. Among so many, figures that
differ by nothing but direction are to be expected, and the comparison of all with all in all
readings would take seconds."""

MOST_COMPARED = 1
"""Readings of a kind that are compared elastically, of up to eight: those nearest step by step. Of
576 air-drawn digits, letters and commands none was named otherwise with 1, 2, 3, 4 or all."""

REMEMBERED = 4
"""Languages whose references are remembered: one, and a few versions with a change, each of up to
ten megabytes."""

ROWS_AT_ONCE = 64
"""Rows that a query is compared with at once: the costs of all their steps stay in the cache."""

_ELASTIC = tuple(voter.name for voter in MOTION_VOTERS if isinstance(voter, ElasticVoter))

_UNORDERED = tuple(voter.name for voter in MOTION_VOTERS if isinstance(voter, UnorderedVoter))

_TEMPO = [voter.name for voter in MOTION_VOTERS].index("tempo")


@dataclass(frozen=True, eq=False)
class NearestReadings:
    """The readings of G gestures that fit a query best.

    Attributes
    ----------
    rows
        ``(G,)``: which row of the references; -1 for a gesture without demonstration.
    distances
        ``(V, G)`` to these readings, infinite for a gesture without demonstration.

    """

    rows: npt.NDArray[np.intp]
    distances: FloatArray


@dataclass(frozen=True, eq=False)
class MotionReferences:
    """What a query's movement is compared with: R rows, each a gesture in one reading.

    Attributes
    ----------
    landmarks
        The landmarks to follow in a query.
    gestures
        ``(R,)`` index of each row's gesture in the language.
    readings
        Of each row.
    descriptors
        Per voter's name ``(R, ...)``.

    """

    landmarks: tuple[str, ...]
    gestures: npt.NDArray[np.intp]
    readings: tuple[Reading, ...]
    descriptors: dict[str, FloatArray]

    @classmethod
    def of(cls, gestures: Sequence[Gesture]) -> MotionReferences:
        """Describe all gestures that have a demonstration, in all thinkable readings.

        The references of the last few languages are remembered: the same gestures are asked for
        again with their thresholds, and whenever only the drawings or the voters' weights change.
        """
        return _remembered(tuple(ShownGesture.of(gesture) for gesture in gestures))

    @classmethod
    def of_shown(cls, gestures: Sequence[ShownGesture]) -> MotionReferences:
        """Describe them anew."""
        landmarks = followed_landmarks([gesture.salient for gesture in gestures])
        every = len(gestures) <= MAX_GESTURES_READ_OTHERWISE
        described = {
            index: gesture.read(landmarks, every=every)
            for index, gesture in enumerate(gestures)
            if gesture.trajectory is not None and len(gesture.trajectory) > 1 and gesture.salient
        }
        sizes = np.array([len(each.readings) for each in described.values()], dtype=np.intp)
        return cls(
            landmarks,
            np.repeat(np.array([*described], dtype=np.intp), sizes),
            tuple(reading for each in described.values() for reading in each.readings),
            {
                voter.name: np.concatenate(
                    [each.descriptors[voter.name] for each in described.values()] or [np.empty(0)]
                )
                for voter in MOTION_VOTERS
            },
        )

    def __len__(self) -> int:
        """Count the rows."""
        return len(self.gestures)

    @cached_property
    def as_shown(self) -> npt.NDArray[np.intp]:
        """Rows of the gestures as they were demonstrated."""
        return np.flatnonzero(self._shown)

    def kept(self, rows: npt.NDArray[np.intp]) -> MotionReferences:
        """Keep some of the rows."""
        return MotionReferences(
            self.landmarks,
            self.gestures[rows],
            tuple(self.readings[row] for row in rows),
            {name: values[rows] for name, values in self.descriptors.items()},
        )

    def distances(self, query: dict[str, FloatArray]) -> FloatArray:
        """Compare a query, described per voter, with the rows that are `promising`.

        Returns
        -------
        ``(V, R)``; infinite for the other rows.

        """
        rows = self.promising(query["path"])
        distances = np.full((len(MOTION_VOTERS), len(self)), np.inf)
        distances[:, rows] = self._measured(query, rows)
        return distances

    def promising(self, path: FloatArray) -> npt.NDArray[np.intp]:
        """Choose the readings that are worth an elastic comparison with a query.

        Of each gesture the one as shown, and of each kind of reading (forwards, backwards, with
        exchanged sides) the `MOST_COMPARED` whose paths lie nearest, step by step.

        Parameters
        ----------
        path
            The query, as voter ``path`` describes it.

        Returns
        -------
        Indices of rows, in order.

        """
        steps = self.descriptors["path"] - path
        apart = np.einsum("rnd,rnd->r", steps, steps)
        chosen = self._shown.copy()
        chosen[np.lexsort((apart, self._kinds))[self._first_of_kind]] = True
        return np.flatnonzero(chosen)

    @cached_property
    def _shown(self) -> npt.NDArray[np.bool_]:
        """``(R,)``: whether a row is a gesture as it was demonstrated."""
        return np.asarray(np.diff(self.gestures, prepend=-1) != 0)

    @cached_property
    def _kinds(self) -> npt.NDArray[np.intp]:
        """``(R,)``: a number for each row's gesture and kind of reading."""
        kinds = [2 * reading.exchanged + reading.backward for reading in self.readings]
        return 4 * self.gestures + np.array(kinds, dtype=np.intp)

    @cached_property
    def _first_of_kind(self) -> npt.NDArray[np.intp]:
        """Where the first `MOST_COMPARED` of each kind stand once the rows are sorted by kind."""
        kinds = np.sort(self._kinds)
        rank = np.arange(len(kinds)) - np.searchsorted(kinds, kinds)
        return np.flatnonzero(rank < MOST_COMPARED)

    @cached_property
    def _elastic(self) -> ElasticViews:
        """What the elastic voters compare with."""
        return ElasticViews(
            tuple(ElasticReferences(self.descriptors[name], BAND) for name in _ELASTIC)
        )

    @cached_property
    def _unordered(self) -> dict[str, StepReferences]:
        """What the unordered voters compare with: the distinct rows."""
        distinct, _ = self._distinct
        return {name: StepReferences(self.descriptors[name][distinct]) for name in _UNORDERED}

    @cached_property
    def _distinct(self) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
        """Rows that differ by more than the order of their steps; and of each row which it is."""
        exchanged = np.array([reading.exchanged for reading in self.readings], dtype=np.intp)
        _, rows, which = np.unique(
            2 * self.gestures + exchanged, return_index=True, return_inverse=True
        )
        return rows, which

    @cached_property
    def penalties(self) -> FloatArray:
        """``(R,)``: the factor on each row's distances."""
        return np.array([reading.penalty for reading in self.readings])

    @cached_property
    def own_distances(self) -> FloatArray:
        """``(V, S, R)``: of the rows as shown, the first so many that are read otherwise."""
        rows = self.as_shown[:MAX_GESTURES_READ_OTHERWISE]
        own = np.empty((len(MOTION_VOTERS), len(rows), len(self)))
        for start in range(0, len(self), ROWS_AT_ONCE):
            block = self.kept(np.arange(start, min(start + ROWS_AT_ONCE, len(self))))
            for index, row in enumerate(rows):
                query = {name: values[row] for name, values in self.descriptors.items()}
                own[:, index, start : start + len(block)] = block._measured(query)
        return own

    def _measured(
        self, query: dict[str, FloatArray], rows: npt.NDArray[np.intp] | None = None
    ) -> FloatArray:
        """Compare a query with M of the rows, all when not given: ``(V, M)``.

        The elastic voters' alignments are found together, which costs hardly more than one.
        """
        chosen = slice(None) if rows is None else rows
        costs = self._elastic.step_costs([query[name] for name in _ELASTIC], rows)
        found = dict(zip(_ELASTIC, alignment_costs(costs, len(query["path"]), BAND), strict=True))
        _, which = self._distinct
        for voter in MOTION_VOTERS:
            asked, others = query[voter.name], self.descriptors[voter.name]
            if isinstance(voter, UnorderedVoter):
                to_distinct = voter.distances_to(asked, self._unordered[voter.name])
                found[voter.name] = to_distinct[which[chosen]]
            elif voter.name not in found:
                found[voter.name] = voter.distances(asked, others[chosen])
        return np.array([found[voter.name] for voter in MOTION_VOTERS])

    def nearest(
        self, query: dict[str, FloatArray], say: FloatArray, between: FloatArray, count: int
    ) -> NearestReadings:
        """Choose for each gesture the reading that fits a query best.

        Parameters
        ----------
        query
            Described per voter.
        say, between
            Of the voters, see `fusion.says`.
        count
            G, the number of gestures in the language.

        """
        compared = self.promising(query["path"])
        measured = self._measured(query, compared)
        scores = fused(measured, say, between) * self.penalties[compared]
        # Writing the best last lets it stay, and of equals the first: as shown.
        order = np.argsort(scores, kind="stable")[::-1]
        chosen = np.full(count, -1, dtype=np.intp)
        chosen[self.gestures[compared[order]]] = order
        found = chosen >= 0
        distances = np.full((len(MOTION_VOTERS), count), np.inf)
        distances[:, found] = measured[:, chosen[found]]
        return NearestReadings(np.where(found, compared[chosen], -1), distances)


@lru_cache(maxsize=REMEMBERED)
def _remembered(gestures: tuple[ShownGesture, ...]) -> MotionReferences:
    return MotionReferences.of_shown(gestures)


def tempo_counts(
    references: MotionReferences,
    own: FloatArray,
    say: FloatArray,
    between: FloatArray,
    gestures: Sequence[Gesture],
) -> npt.NDArray[np.bool_]:
    """Tell ``(G,)`` whose tempo the language needs, unless the author has said.

    Of two gestures that are the same movement but for the time it takes. Parameters as for
    `unambiguous`.
    """
    shown = references.as_shown
    scores = fused(own, say, between)[:, shown]
    doublings = own[_TEMPO][:, shown]
    twins = (scores < SAME_FIGURE) & (doublings > CLEARLY_SLOWER)
    needed = np.zeros(len(gestures), dtype=bool)
    needed[references.gestures[shown]] = twins.any(axis=0)
    for index, gesture in enumerate(gestures):
        if gesture.switches.tempo != "auto":
            needed[index] = gesture.switches.tempo == "on"
    return needed


def describe_movement(trajectory: Trajectory, landmarks: Sequence[str]) -> dict[str, FloatArray]:
    """Describe a query once for each voter."""

    def work_out() -> dict[str, FloatArray]:
        seen = movement(trajectory, landmarks)
        return {voter.name: voter.describe(seen) for voter in MOTION_VOTERS}

    return trajectory.once(("movement", tuple(landmarks)), work_out)


def unambiguous(
    references: MotionReferences,
    own: FloatArray,
    say: FloatArray,
    between: FloatArray,
    free: Collection[int] = (),
) -> MotionReferences:
    """Drop the readings by which a gesture would be taken for another one of the language.

    The language needs the direction of a gesture when another one is the same figure the other way
    round: wherever both begin, they lie within `SAME_FIGURE` of each other when one of them is
    turned round, or within `TURNED` times what they do when not, and at least clear of that. It
    needs its sides when another one is the same figure with left and right exchanged.

    Parameters
    ----------
    references
        In all thinkable readings.
    own
        `own_distances` of the rows as shown.
    say, between
        Of the voters, see `fusion.says`.
    free
        Indices of gestures whose direction does not count, whatever the others are.

    """
    labels = references.gestures
    shown = references.as_shown
    same = labels[shown][:, None] == labels[None]
    scores = np.where(same, np.inf, fused(own, say, between))
    backward = np.array([reading.backward for reading in references.readings], dtype=bool)
    exchanged = np.array([reading.exchanged for reading in references.readings], dtype=bool)
    keep = np.ones(len(references), dtype=bool)
    for gesture in np.unique(labels):
        rows = labels == gesture
        plain = scores[:, rows & ~backward & ~exchanged].min(axis=1)
        for otherwise, matters in ((backward, gesture not in free), (exchanged, True)):
            turned = scores[:, rows & otherwise].min(axis=1, initial=np.inf)
            alike = np.maximum(SAME_FIGURE, TURNED * plain)
            if matters and ((turned < alike) & (turned < CLEARANCE * plain)).any():
                keep[rows & otherwise] = False
    return references.kept(np.flatnonzero(keep))
