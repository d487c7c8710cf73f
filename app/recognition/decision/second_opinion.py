"""Second opinion: another way of comparing, whose agreement counts.

The score is a weighted mean, of which compressed velocities are the largest part. The voter
`second_opinion` compares the same rows by directions alone. It fails on other takes, so that a take
of which both say the same is more often right, and one of which they differ is more often wrong.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from app.recognition.decision.outcome import SCORE_FLOOR, find_answer
from app.recognition.decision.score_table import ScoreTable
from app.recognition.voters.motion_voters import SecondOpinion

OPINION_EXPONENT: Final = 0.2
"""Exponent of the second opinion's ratios, where the score's own ratios have 1; also its weight
beside that of all other voters (`benchmarks/studies/rejection.md`)."""

ORDER_RATIO: Final = 1.05
"""Largest ratio of a score to the smallest one at which the second opinion may make it the nearest.
"""

AGREED: Final = 1.15
"""Factor of the limit for the gesture that is nearest by the second opinion too, in a clear take.
"""


def hear(table: ScoreTable, factor: float) -> ScoreTable:
    """Let the second opinion add its part to the scores, and release a clear take that it names.

    A score is multiplied by the ratio of the second opinion's distance to its smallest one, to the
    power of `OPINION_EXPONENT`. It chooses among the gestures within `ORDER_RATIO`; no other
    becomes the nearest. What it adds is its contribution.

    Parameters
    ----------
    table
        Without its part.
    factor
        On the exponent, by the language's tuning.

    Returns
    -------
    Where it abstains, with `factor` 0, and where fewer than two gestures are comparable, the table
    with all its distances infinite.

    """
    row, scores = table.voters.index(SecondOpinion.name), table.scores
    known, opinion = np.isfinite(scores), table.distances[row]
    if not factor or known.sum() < 2 or not np.isfinite(opinion[known]).all():
        silent = np.arange(len(table.distances))[:, None] == row
        return replace(table, distances=np.where(silent, np.inf, table.distances))
    ratios = (opinion[known] + SCORE_FLOOR) / (opinion[known].min() + SCORE_FLOOR)
    apart = scores[known] * ratios ** (OPINION_EXPONENT * factor)
    near = scores[known] <= ORDER_RATIO * scores[known].min()
    apart[~near] = np.maximum(apart[~near], ORDER_RATIO * apart[near].min())
    contributions, novelty = table.contributions.copy(), table.novelty_by_view.copy()
    contributions[row, known] += apart - scores[known]
    named = int(opinion.argmin())
    novelty[0, named] /= AGREED
    heard = replace(table, contributions=contributions)
    released = replace(heard, novelty_by_view=novelty)
    answer = find_answer(released.scores, released.novelty, named)
    return released if answer == (named,) else heard
