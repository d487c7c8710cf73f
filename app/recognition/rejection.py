"""Rejection: whether a movement is any gesture of the language at all.

The fused score (`fusion`) tells which gesture is nearest, in units of what the language's gestures
differ by; it says little about a movement that is none of them. Novelty (novelty detection,
Pimentel et al. 2014) is absolute instead: each voter's distance is divided by the gesture's own
threshold for that voter, and

    novelty = penalty of the reading * mean over `NOVELTY_VOTERS` of distance / threshold.

Above 1 the gesture is rejected. The thresholds come from plausible takes of the demonstration
(`calibration`) and are kept in the language file.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from app.recognition.gesture import Gesture
from app.recognition.poses import FloatArray

NOVELTY_VOTERS: Final = ("path", "direction", "posture", "hand_attitude", "which_hand")
"""The voters that follow the movement and do not repeat each other, all counting the same. Weights,
powers of the mean and more voters moved the foreign movements accepted by less than 1 of 10 %."""


def thresholds_of(gestures: Sequence[Gesture], voters: Sequence[str]) -> FloatArray:
    """Gather the thresholds of gestures: ``(V, G)``, infinite where a gesture has none."""
    return np.array(
        [
            [
                gesture.thresholds.get(voter, np.inf) if voter in NOVELTY_VOTERS else np.inf
                for gesture in gestures
            ]
            for voter in voters
        ]
    )


def novelty(distances: FloatArray, thresholds: FloatArray, weights: FloatArray) -> FloatArray:
    """Measure how much farther than its thresholds allow a query lies from each gesture.

    Parameters
    ----------
    distances, thresholds
        ``(V, G)``; voters that cannot compare, or have no threshold, are infinite.
    weights
        ``(V,)``, 0: left out.

    Returns
    -------
    ``(G,)``: the weighted mean of distance over threshold; NaN where no voter has both.

    """
    weighing = np.where(np.isfinite(distances) & np.isfinite(thresholds), weights[:, None], 0.0)
    relative = np.where(weighing > 0, distances, 0.0) / thresholds
    total = weighing.sum(axis=0)
    summed = (weighing * relative).sum(axis=0)
    return np.asarray(np.divide(summed, total, out=np.full_like(total, np.nan), where=total > 0))


def is_rejected(novelty: float) -> bool:
    """Tell whether a gesture is rejected; one without thresholds (NaN) never is."""
    return novelty > 1.0
