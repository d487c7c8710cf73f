"""Score table: the distances of a query to every gesture, and each voter's contribution."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from app.recognition.decision.result import Recognition
from app.recognition.features.traversals import Traversal
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory


@dataclass(frozen=True, eq=False, kw_only=True)
class ScoreTable:
    """The distances and contributions of all voters for a query and all gestures.

    Attributes
    ----------
    voters
        V names.
    distances
        ``(V, G)``, each voter in its own unit; infinite where not comparable.
    contributions
        ``(V, G)``: what each voter adds to a gesture's score, smaller = more alike; 0 where it
        cannot compare or has weight 0, infinite for a gesture that no voter can compare.
    turned
        ``(G,)``: penalty for a gesture that is nearest backwards or with exchanged sides.
    traversals
        The nearest traversal of each gesture; None where only its image is compared.
    mirrored
        ``(G,)``: whether the gesture's mirror image is nearest.
    demonstrations
        ``(G,)``: index of each gesture's nearest demonstration.
    views
        ``(G,)``: degrees by which that demonstration was turned before it was compared
        (`views.Views`).
    facing
        Degrees by which the query's diver is turned from the camera, positive to the diver's own
        left; None where not known.
    novelty_by_view
        ``(2, G)``: novelty for each gesture by each of `outcome.NOVELTIES` alone; NaN where it
        is not compared, all of profile ``paper``.

    """

    voters: tuple[str, ...]
    distances: FloatArray
    contributions: FloatArray
    turned: FloatArray
    traversals: tuple[Traversal | None, ...]
    mirrored: npt.NDArray[np.bool_]
    novelty_by_view: FloatArray
    demonstrations: npt.NDArray[np.intp]
    views: npt.NDArray[np.intp]
    facing: float | None = None

    def nearest_demonstration(self, gesture: int) -> int:
        """Return the index of the demonstration by which a gesture, given by index, is compared."""
        return int(self.demonstrations[gesture])

    def find_shown_demonstration(self, gestures: Sequence[Gesture], gesture: int) -> Gesture:
        """Return a gesture with only the demonstration that the query was compared with."""
        return gestures[gesture].single_demonstrations()[self.nearest_demonstration(gesture)]

    def find_nearest_demonstration(self, gestures: Sequence[Gesture], gesture: int) -> Gesture:
        """Return the shown demonstration, turned as it was compared."""
        return self.find_shown_demonstration(gestures, gesture).turn(int(self.views[gesture]))

    def with_idle_voters(self, names: Sequence[str]) -> ScoreTable:
        """Return the table with rows of further voters, which compare nothing."""
        nothing = np.full((len(names), self.distances.shape[1]), np.inf)
        return replace(
            self,
            voters=(*self.voters, *names),
            distances=np.concatenate([self.distances, nothing]),
            contributions=np.concatenate([self.contributions, np.zeros(nothing.shape)]),
        )

    @property
    def scores(self) -> FloatArray:
        """``(G,)``: the sums of contributions and `turned`, smaller = more alike.

        Profile ``full``: the fused distance, which decides. Profile ``paper``: the mean relative
        distance, which decides among gestures with equally many votes.
        """
        return np.asarray(self.contributions.sum(axis=0) + self.turned, dtype=np.float64)

    @property
    def novelty(self) -> FloatArray:
        """``(G,)``: the larger of both novelties, above 1: rejected (`outcome`).

        NaN for all gestures in profile ``paper``.
        """
        return np.asarray(np.fmax.reduce(self.novelty_by_view, axis=0))


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace:
    """The query, score table and result of one recognition.

    Attributes
    ----------
    query
        The trajectory that the voters compared.
    score_table
        Its distances to every gesture.
    result
        The recognition.

    """

    query: Trajectory
    score_table: ScoreTable
    result: Recognition
