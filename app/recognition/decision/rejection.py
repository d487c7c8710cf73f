"""Rejection: novelty detection, which decides whether a take is a gesture of the language.

The fused score (`fusion`) ranks the gestures and is relative to their differences; it says little
about out-of-vocabulary movements. Novelty (Pimentel et al. 2014) is absolute: each voter's distance
is divided by the gesture's threshold for it, and

    novelty = penalty of the traversal * clearness * max over the cue groups of the mean of
              distance / threshold.

Above 1 the gesture is rejected. Clearness (`measure_clearness`) widens the thresholds where the
gesture is much nearer than any other, and narrows them between two that are about as near. The mean
evens out the noise of voters that measure the same property (`Voter.cue`): the movement, or its
place beside the body. The maximum ensures that a movement at the right place is not accepted for
its place. Thresholds come from simulated takes of the demonstration (`calibration`) and are stored
in the language file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final

import numpy as np

from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.registry import VOTERS
from app.recognition.voters.voter import Voter


def _group_cues(voters: Sequence[Voter]) -> Mapping[str, Mapping[str, float]]:
    groups: dict[str, dict[str, float]] = {}
    for voter in voters:
        if voter.cue is not None:
            groups.setdefault(voter.cue, {})[voter.name] = 1.0
    return MappingProxyType({name: MappingProxyType(group) for name, group in groups.items()})


CUE_GROUPS: Final[Mapping[str, Mapping[str, float]]] = _group_cues(VOTERS)
"""Weights of voters by cue group and name."""

HAND_CUE_GROUP: Final = "hand"
"""The cue group of the hand voters, in languages with held hand shapes. Clearness is not used: all
pairs of shapes differ about equally, so that an out-of-vocabulary shape is mostly clear."""

SCORE_FLOOR = 0.02
"""Added to scores and novelties before the logarithm: the value of two takes by one careful person.
"""

CLEAR_SHARE = 0.6
"""Ratio of a score to that of the nearest other gesture at which thresholds apply unchanged. On
eleven sets, 13 % of the gestures' own takes are then rejected and 24 % of out-of-vocabulary takes
accepted; without clearness 14 and 37 % (`benchmarks/studies/people.md`)."""

CLEARNESS_EXPONENT = 2.0
"""Exponent of the share; values from 1 to 3 separate own from out-of-vocabulary takes equally
well."""

MOST_CLEAR = 1 / 3
"""Least clearness: however far the other gestures are, thresholds widen three times at most."""


def gather_thresholds(gestures: Sequence[Gesture], voters: Sequence[str]) -> FloatArray:
    """Return the thresholds of gestures: ``(V, G)``, infinite where a gesture has none."""
    return np.array(
        [[gesture.thresholds.get(voter, np.inf) for gesture in gestures] for voter in voters]
    )


def build_novelty_weights(voters: Sequence[str]) -> FloatArray:
    """Return the weight of each voter in each of the `CUE_GROUPS`, ``(K, V)``."""
    return np.array([[view.get(voter, 0.0) for voter in voters] for view in CUE_GROUPS.values()])


def measure_novelty(
    distances: FloatArray, thresholds: FloatArray, weights: FloatArray
) -> FloatArray:
    """Compute the novelty of a query for each gesture; above 1 it is rejected.

    Parameters as for `measure_group_novelties`.

    Returns
    -------
    ``(G,)``: the largest of the cue groups' novelties; NaN where no group has one.

    """
    return take_largest_novelty(measure_group_novelties(distances, thresholds, weights))


def take_largest_novelty(by_view: FloatArray) -> FloatArray:
    """Return the largest of K cue groups' novelties ``(K, G)``: ``(G,)``; NaN where all are NaN."""
    return np.asarray(np.fmax.reduce(by_view, axis=0))


def measure_group_novelties(
    distances: FloatArray, thresholds: FloatArray, weights: FloatArray
) -> FloatArray:
    """Compute the novelty of a query for each gesture in each cue group.

    Parameters
    ----------
    distances, thresholds
        ``(V, G)``; voters that cannot compare, or have no threshold, are infinite.
    weights
        ``(K, V)`` of each voter in each cue group, 0: left out.

    Returns
    -------
    ``(K, G)``: the weighted means of distances over thresholds; NaN where no voter has both.

    """
    if np.isfinite(distances).all():
        # Without a threshold the distance is divided by infinity and adds 0.
        total = weights @ np.isfinite(thresholds)
        with np.errstate(invalid="ignore"):
            return np.asarray(weights @ (distances / thresholds) / total)
    known = np.isfinite(distances) & np.isfinite(thresholds)
    relative = np.where(known, distances, 0.0) / np.where(known, thresholds, 1.0)
    total = weights @ known
    means: FloatArray = np.full_like(total, np.nan)
    np.divide(weights @ relative, total, out=means, where=total > 0)
    return means


def measure_clearness(scores: FloatArray) -> FloatArray:
    """Compute the factor on each gesture's novelty for how near the other gestures are.

    Takes by two people differ more than two takes by one person, and how much more depends on the
    language; the distances to the other gestures give the scale.

    Parameters
    ----------
    scores
        ``(G,)``; infinite where not comparable.

    Returns
    -------
    ``(G,)``: ``((score / least other score) / CLEAR_SHARE) ** 2``, at least `MOST_CLEAR`; 1 where
    no other gesture is comparable.

    """
    clearness = np.ones(len(scores))
    comparable = np.isfinite(scores)
    if comparable.sum() < 2:
        return clearness
    first, second = np.argsort(scores)[:2]
    others = np.full(len(scores), scores[first])
    others[first] = scores[second]
    clearness[comparable] = compare_with_other(scores[comparable], others[comparable])
    return clearness


def compare_with_other(scores: FloatArray, others: FloatArray) -> FloatArray:
    """Compute the clearness of scores ``(N,)``, each beside the least score of another gesture."""
    share = (scores + SCORE_FLOOR) / (others + SCORE_FLOOR)
    return np.maximum((share / CLEAR_SHARE) ** CLEARNESS_EXPONENT, MOST_CLEAR)


def is_rejected(novelty: float) -> bool:
    """Return whether a gesture is rejected; one without thresholds (NaN) never is."""
    return novelty > 1.0
