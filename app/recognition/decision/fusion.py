"""Fusion: the weight of each voter in a language, and one score from all their distances.

A voter's distances are divided by its between-class distance, so that 1 means "as different as two
gestures of the language", whatever the voter's unit. Its weight is

    weight = prior * max(0, 1 - within / between),

where `within` is its within-class distance, measured between two people's takes of one gesture
(`Voter.within`), and `between` its between-class distance, the median distance between two gestures
of this language. A voter whose between-class distance does not exceed its within-class distance
gets weight 0.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.recognition.poses.sequence import FloatArray
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
