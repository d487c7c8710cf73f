"""Vote interface: the decision rule of a profile."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from app.recognition.decision.result import Recognition
from app.recognition.decision.score_table import ScoreTable
from app.recognition.gestures.switches import Sensitivity
from app.recognition.poses.trajectory import Trajectory


class Vote(Protocol):
    """Compares a query with every gesture of a language, and decides for one or none."""

    @property
    def landmarks(self) -> tuple[str, ...]:
        """The salient landmarks of all gestures, in alphabetical order."""
        ...

    @property
    def needed(self) -> tuple[str, ...]:
        """The salient landmarks of which a query must move at least one."""
        ...

    @property
    def weights(self) -> Mapping[str, float]:
        """Each voter's weight in the decision, summing to 1."""
        ...

    @property
    def shape_twins(self) -> frozenset[tuple[int, int]]:
        """Pairs of gestures, the first index the smaller, that the hand shape alone tells apart."""
        ...

    def compare(self, trajectory: Trajectory) -> ScoreTable:
        """Compare a condensed query with every gesture, voter by voter."""
        ...

    def decide(self, compared: ScoreTable) -> Recognition:
        """Decide for one gesture or none; one of the scores must be finite."""
        ...

    def sensitivity(self, gesture: int) -> Sensitivity | None:
        """Return which properties of a gesture count; None for a gesture without movement."""
        ...
