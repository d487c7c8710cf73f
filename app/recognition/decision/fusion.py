"""Fusion: the weight of each voter in a language, and one score from all their distances.

A voter's distances are divided by its between-class distance, so that 1 means "as different as two
gestures of the language", whatever the voter's unit. Its weight is

    weight = prior * max(0, 1 - within / between),

where `within` is its within-class distance, measured between two people's takes of one gesture
(`Voter.within`), and `between` its between-class distance, the median distance between two gestures
of this language. A voter whose between-class distance does not exceed its within-class distance
gets weight 0.

Second opinion: another way of comparing, whose agreement counts.

The score is a weighted mean, of which compressed velocities are the largest part. The voter
`second_opinion` compares the same rows by directions alone. It fails on other takes, so that a take
of which both say the same is more often right, and one of which they differ is more often wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from app.recognition.decision.outcome import SCORE_FLOOR, find_answer
from app.recognition.decision.result import ScoreTable
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion_voters import SecondOpinion
from app.recognition.voters.voter import WeightedVoter

PAIRS_BEFORE = 1
"""Weight, in pairs of gestures, of the voter's general between-class distance: a language of two
has one pair, which may be alike by chance."""


def weigh_voters(
    voters: Sequence[WeightedVoter], own: Sequence[FloatArray], *, arms: bool
) -> tuple[FloatArray, FloatArray]:
    """Compute the weight of each voter in a language.

    Parameters
    ----------
    voters
        V voters.
    own
        Per voter all its finite distances between gestures of the language.
    arms
        Whether the elbows are seen.

    Returns
    -------
    ``(V,)`` weights, not normalised, and ``(V,)`` between-class distances, > 0.

    """
    weights, between = np.zeros(len(voters)), np.ones(len(voters))
    for index, (voter, distances) in enumerate(zip(voters, own, strict=True)):
        known = np.concatenate([distances, np.full(PAIRS_BEFORE, voter.between)])
        between[index] = float(np.median(known))
        apart = max(0.0, 1.0 - voter.within / max(between[index], 1e-9))
        weights[index] = voter.prior_for(arms=arms) * apart
    return weights, np.maximum(between, 1e-9)


def fuse(distances: FloatArray, weights: FloatArray, between: FloatArray) -> FloatArray:
    """Compute fused scores of distances ``(V, ...)``: the sums of `weigh_distances`.

    Returns
    -------
    The weighted mean of the relative distances: 0 for the same, about 1 for another gesture;
    infinite where no voter with a weight can compare.

    """
    return np.asarray(weigh_distances(distances, weights, between).sum(axis=0), dtype=np.float64)


def weigh_distances(distances: FloatArray, weights: FloatArray, between: FloatArray) -> FloatArray:
    """Compute each voter's contribution to the fused score.

    Returns
    -------
    The contributions, in the shape of `distances`, ``(V, ...)``: 0 where a voter has no weight or
    cannot compare; all infinite where no voter with a weight can compare.

    """
    shape = (-1,) + (1,) * (distances.ndim - 1)
    known = np.isfinite(distances)
    if known.all() and (whole := weights.sum()) > 0:
        return np.asarray(distances * (weights / (between * whole)).reshape(shape))
    known_weights = np.where(known, weights.reshape(shape), 0.0)
    relative = np.where(known, distances, 0.0) / between.reshape(shape)
    total = np.broadcast_to(known_weights.sum(axis=0), known_weights.shape)
    shares: FloatArray = np.full(known_weights.shape, np.inf)
    np.divide(known_weights * relative, total, out=shares, where=total > 0)
    return shares


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
