"""Recognition trace: a result together with the query and score table behind it."""

from __future__ import annotations

from dataclasses import dataclass

from app.recognition.decision.result import Recognition
from app.recognition.decision.score_table import ScoreTable
from app.recognition.poses.trajectory import Trajectory


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
