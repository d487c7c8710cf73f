"""Majority vote of profile ``paper``: each voter votes for its nearest gesture."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import chain
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from app.recognition.decision.outcome import NOVELTIES
from app.recognition.decision.result import Recognition, ScoreTable
from app.recognition.features.trajectory_image import SIMPLIFICATION, draw
from app.recognition.gestures.gesture import Gesture
from app.recognition.gestures.profile import AS_THE_PROFILE, Tuning
from app.recognition.gestures.switches import Sensitivity
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.voters.registry import PAPER_VOTERS
from app.recognition.voters.shape_voters import describe_drawing


class MajorityVote:
    """Counts the votes of the paper's seven voters (paper, Sec. IV-D); never rejects.

    Parameters
    ----------
    gestures
        G gestures, at least one.
    tuning
        Its weight factors are the weights of the votes.

    Raises
    ------
    OsgError
        When the weights do not fit the voters.

    """

    def __init__(self, gestures: Sequence[Gesture], tuning: Tuning = AS_THE_PROFILE) -> None:
        self._labels = tuple(gesture.label for gesture in gestures)
        self._factors = tuning.weights_of([voter.name for voter in PAPER_VOTERS])
        shown = [gesture.single_demonstrations() for gesture in gestures]
        self._first = np.cumsum([0, *map(len, shown[:-1])])
        self._simplification = tuning.simplification
        every = [*chain(*shown)]
        if self._simplification != SIMPLIFICATION:
            every = [gesture.redraw(self._simplification) for gesture in every]
        self._count, self._drawings = len(every), _group_drawings(every)

    @property
    def needed(self) -> tuple[str, ...]:
        """The salient landmarks of all gestures, of which a query must move one, in order."""
        return tuple(sorted({name for salient in self._drawings for name in salient}))

    landmarks = needed
    """The same: these are followed in a query."""

    @property
    def weights(self) -> Mapping[str, float]:
        """Each voter's share of the votes, summing to 1."""
        shares = (self._factors / self._factors.sum()).tolist()
        return {voter.name: share for voter, share in zip(PAPER_VOTERS, shares, strict=True)}

    @property
    def shape_twins(self) -> frozenset[tuple[int, int]]:
        """No pairs, because hands are not compared."""
        return frozenset()

    undecided_twins = shape_twins

    def sensitivity(self, gesture: int) -> Sensitivity | None:
        """Return None: only drawings are compared, whatever the switches are."""
        return None

    def compare(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a condensed query with every gesture, voter by voter.

        A gesture's distance is that of its nearest demonstration.
        """
        of_all = self._measure(trajectory)
        distances = np.minimum.reduceat(of_all, self._first, axis=1)
        relative = weigh_relative_distances(of_all, self._factors).sum(axis=0)
        count = len(self._labels)
        return ScoreTable(
            voters=tuple(voter.name for voter in PAPER_VOTERS),
            distances=distances,
            contributions=weigh_relative_distances(distances, self._factors),
            turned=np.zeros(count),
            traversals=(None,) * count,
            mirrored=np.zeros(count, dtype=bool),
            novelty_by_view=np.full((len(NOVELTIES), count), np.nan),
            demonstrations=np.array(
                [part.argmin() for part in np.split(relative, self._first[1:])]
            ),
            views=np.zeros(count, dtype=np.intp),
        )

    def _measure(self, query: Trajectory) -> FloatArray:
        """Compute the distances ``(7, S)`` of a query to all demonstrations.

        The query is drawn and described once per distinct set of salient landmarks. Infinite where
        it lacks a salient landmark, or does not move it.
        """
        distances = np.full((len(PAPER_VOTERS), self._count), np.inf)
        for salient, drawings in self._drawings.items():
            if not set(salient) <= set(query.landmarks):
                continue
            described = query.compute_once(
                ("drawing", salient, self._simplification),
                partial(_describe, query, salient, self._simplification),
            )
            if described:
                distances[:, drawings.members] = [
                    voter.distances(described[voter.name], drawings.described[voter.name])
                    for voter in PAPER_VOTERS
                ]
        return distances

    def decide(self, compared: ScoreTable) -> Recognition:
        """Return the gesture with most votes; see `count_votes`."""
        return self.count_votes(compared.distances)

    def count_votes(self, distances: FloatArray) -> Recognition:
        """Count the votes by distances ``(7, G)``.

        Of gestures with equally many votes, the one with the smallest mean relative distance wins;
        if these are equal too, the first in the language.
        """
        gestures = self._labels
        votes = {
            voter.name: int(row.argmin())
            for voter, row in zip(PAPER_VOTERS, distances, strict=True)
            if np.isfinite(row).any()
        }
        voters = tuple(voter.name for voter in PAPER_VOTERS)
        weights = self.weights
        count: dict[int, float] = defaultdict(float)
        for voter, index in votes.items():
            count[index] += weights[voter]
        relative = weigh_relative_distances(distances, self._factors).sum(axis=0)
        winner = min(count, key=lambda index: (-count[index], relative[index], index))
        return Recognition(
            label=gestures[winner],
            nearest=gestures[winner],
            confidence=(count[winner] / sum(count.values()) + _margin(relative, winner)) / 2,
            profile="paper",
            voters=voters,
            gestures=gestures,
            distances=distances,
            votes={voter: gestures[index] for voter, index in votes.items()},
            weights=weights,
            scores=relative,
            novelty=np.full(len(gestures), np.nan),
        )


def weigh_relative_distances(distances: FloatArray, weights: FloatArray) -> FloatArray:
    """Weigh each voter's distances relative to its mean, so that different units add up.

    Parameters
    ----------
    distances
        ``(V, G)``, infinite where not comparable.
    weights
        ``(V,)``, 0: left out.

    Returns
    -------
    ``(V, G)``, whose sum over the voters is the mean relative distance: the weighted mean, over
    the voters that can compare anything, of a distance divided by that voter's mean over all
    comparable gestures. 1 = as far as the average gesture; infinite where not comparable.

    """
    comparable = np.isfinite(distances)
    voting = comparable.any(axis=1) & (weights > 0)
    if not voting.any():
        return np.full_like(distances, np.inf)
    sums = np.where(comparable, distances, 0.0).sum(axis=1)
    means = sums[voting] / comparable[voting].sum(axis=1)
    shares = weights[voting] / weights[voting].sum()
    contributions = np.zeros_like(distances)
    contributions[voting] = distances[voting] * (shares / np.where(means > 0, means, 1.0))[:, None]
    return contributions


def _margin(relative: FloatArray, winner: int) -> float:
    """Return 1 - (the winner's distance over the nearest other's), 0 where the other is nearer."""
    nearest_other = float(np.delete(relative, winner).min(initial=np.inf))
    if relative[winner] >= nearest_other:
        return 0.0
    return 1.0 - float(relative[winner]) / nearest_other


class _Drawings(NamedTuple):
    """The demonstrations with the same salient landmarks, which share one drawing of the query.

    Attributes
    ----------
    members
        ``(M,)``: their indices.
    described
        Per voter ``(M, D)`` descriptors.

    """

    members: npt.NDArray[np.intp]
    described: dict[str, FloatArray]


def _group_drawings(shown: Sequence[Gesture]) -> dict[tuple[str, ...], _Drawings]:
    """Group the demonstrations that can be compared by their salient landmarks."""
    members: dict[tuple[str, ...], list[int]] = {}
    for index, gesture in enumerate(shown):
        if gesture.salient and gesture.image.any():
            members.setdefault(gesture.salient, []).append(index)
    return {
        salient: _Drawings(np.array(indices), _stack([shown[index] for index in indices]))
        for salient, indices in members.items()
    }


def _stack(shown: Sequence[Gesture]) -> dict[str, FloatArray]:
    """Return the descriptors of M drawings, computing those that are not stored."""
    described = []
    for gesture in shown:
        missing = [voter for voter in PAPER_VOTERS if voter.name not in gesture.descriptors]
        described.append({**gesture.descriptors, **describe_drawing(gesture.drawing, missing)})
    return {
        voter.name: np.stack([each[voter.name] for each in described]) for voter in PAPER_VOTERS
    }


def _describe(
    query: Trajectory, salient: tuple[str, ...], simplification: float
) -> dict[str, FloatArray]:
    """Draw and describe salient landmarks; empty where one of them is never seen."""
    seen = query.select(salient)
    if not np.isfinite(seen.xy).all(axis=2).any(axis=0).all():
        return {}
    return describe_drawing(draw(seen, simplification), PAPER_VOTERS)
