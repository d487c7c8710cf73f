"""An examination: a recognition together with what led to it."""

from __future__ import annotations

from dataclasses import dataclass

from app.recognition.decision.result import Recognition
from app.recognition.decision.score_table import ScoreTable
from app.recognition.poses.trajectory import Trajectory


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace:
    """What a recogniser saw, compared and decided.

    Attributes
    ----------
    query
        The recording as the voters see it.
    comparison
        It, beside every gesture.
    result
        The answer.

    """

    query: Trajectory
    comparison: ScoreTable
    result: Recognition
