"""Rejection: whether a query is any gesture of the language at all.

The fused score (`fusion`) tells which gesture is nearest, in units of what the language's gestures
differ by; it says little about an out-of-vocabulary movement. Novelty (novelty detection, Pimentel
et al. 2014) is absolute: each voter's distance is divided by the gesture's threshold for it, and

    novelty = penalty of the traversal * max over the cue groups of the weighted mean of
              distance / threshold.

Above 1 the gesture is rejected. Voters of one cue group (`Cue.group`) look at the same thing and
make up for each other's noise; groups do not, so that an arm held as demonstrated cannot make up
for another figure. Thresholds come from simulated takes of the demonstration (`calibration`) and
are kept in the language file.
"""

from __future__ import annotations

import math
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
            groups.setdefault(voter.cue.group, {})[voter.name] = voter.cue.weight
    return MappingProxyType({name: MappingProxyType(group) for name, group in groups.items()})


CUE_GROUPS: Final[Mapping[str, Mapping[str, float]]] = _group_cues(VOTERS)
"""Per cue group the weights of its voters, by name."""

SCORE_FLOOR = 0.02
"""Added to scores and novelties before their logarithm: those of two takes by the same careful
person."""

CONFIDENCE_AT_ONE = -0.3
CONFIDENCE_PER_NOVELTY = -3.3
CONFIDENCE_PER_SHARE = -0.25
"""Coefficients of `estimate_confidence`, fitted on five sets, each set and people's relation
weighing the same. The share's is held below what fits best (-0.85), for hardly a worse fit:
foreign movements are told by novelty. Fitted on four sets, the confidences hold on the fifth."""


def gather_thresholds(gestures: Sequence[Gesture], voters: Sequence[str]) -> FloatArray:
    """Gather the thresholds of gestures: ``(V, G)``, infinite where a gesture has none."""
    return np.array(
        [[gesture.thresholds.get(voter, np.inf) for gesture in gestures] for voter in voters]
    )


def build_novelty_weights(voters: Sequence[str]) -> FloatArray:
    """Return the weight of each voter in each of the `CUE_GROUPS`, ``(K, V)``."""
    return np.array([[view.get(voter, 0.0) for voter in voters] for view in CUE_GROUPS.values()])


def measure_novelty(
    distances: FloatArray, thresholds: FloatArray, weights: FloatArray
) -> FloatArray:
    """Measure how far a query lies from each gesture, where 1 is the farthest that is accepted.

    Parameters as for `measure_group_novelties`.

    Returns
    -------
    ``(G,)``: the largest of the views' novelties; NaN where no view has one.

    """
    return take_largest_novelty(measure_group_novelties(distances, thresholds, weights))


def take_largest_novelty(by_view: FloatArray) -> FloatArray:
    """Return the largest of novelties ``(K, G)`` by view: ``(G,)``; NaN where no view has one."""
    return np.asarray(np.fmax.reduce(by_view, axis=0))


def measure_group_novelties(
    distances: FloatArray, thresholds: FloatArray, weights: FloatArray
) -> FloatArray:
    """Measure how far a query lies from each gesture in each view alone.

    Parameters
    ----------
    distances, thresholds
        ``(V, G)``; voters that cannot compare, or have no threshold, are infinite.
    weights
        ``(K, V)`` of each voter in each view, 0: left out.

    Returns
    -------
    ``(K, G)``: the weighted means of distances over thresholds; NaN where no voter has both.

    """
    if np.isfinite(distances).all():
        # What has no threshold is divided by infinity, and so counts nothing.
        total = weights @ np.isfinite(thresholds)
        with np.errstate(invalid="ignore"):
            return np.asarray(weights @ (distances / thresholds) / total)
    known = np.isfinite(distances) & np.isfinite(thresholds)
    relative = np.where(known, distances, 0.0) / np.where(known, thresholds, 1.0)
    total = weights @ known
    means: FloatArray = np.full_like(total, np.nan)
    np.divide(weights @ relative, total, out=means, where=total > 0)
    return means


def is_rejected(novelty: float) -> bool:
    """Return whether a gesture is rejected; one without thresholds (NaN) never is."""
    return novelty > 1.0


TIE_EXPONENT = 3.5
"""How quickly the nearest of two gestures becomes the one meant as the other is farther: a logistic
fit to 800 queries by other people of digits, letters and both two-handed sets. A runner-up 1.2
times as far leaves it at 0.65 (measured 0.5), twice as far at 0.92 (0.9)."""


def estimate_confidence(novelty: float, nearest: float, second: float) -> float:
    """Estimate the probability that the nearest gesture is the one meant.

    ``1 / (1 + exp(-(b0 + b1 ln n + b2 ln(s / t))))`` for the novelty n and the scores s of the
    nearest and t of the second gesture, 0.02 added to each: a small novelty says that it is this
    gesture at all, a small share that it is no other one. The coefficients are a logistic
    regression on other people's recordings, half of them of gestures that the language did not
    have; the reliability table is in `docs/results.md`. Never more than the share of a tie that
    its nearness earns, ``1 / (1 + (s / t)^3.5)``: two gestures equally near are even chances,
    however near.

    Parameters
    ----------
    novelty
        Of the nearest gesture. NaN where it has no thresholds: the score then stands in, which is
        about 1 for another gesture.
    nearest, second
        Scores as `fusion.fused` gives them; infinite where there is no second gesture, which then
        counts as one at the typical distance 1.

    """
    far = math.log((novelty if math.isfinite(novelty) else nearest) + SCORE_FLOOR)
    here = math.log(nearest + SCORE_FLOOR)
    there = math.log((second if math.isfinite(second) else 1.0) + SCORE_FLOOR)
    odds = CONFIDENCE_AT_ONE + CONFIDENCE_PER_NOVELTY * far + CONFIDENCE_PER_SHARE * (here - there)
    # Of the exponents both are at most 700: a double ends soon after.
    meant = 1.0 / (1.0 + math.exp(min(-odds, 700.0)))
    this_one = 1.0 / (1.0 + math.exp(min(TIE_EXPONENT * (here - there), 700.0)))
    return min(meant, this_one)
