"""The voter that sees how the wrist is bent: where the hand points, seen from the forearm."""

from __future__ import annotations

import numpy as np

from app.recognition.movement import LIMBS, Movement
from app.recognition.poses import FloatArray

FOREARM = LIMBS.index(("elbow", "wrist"))
HAND = [
    index for index, (inner, outer) in enumerate(LIMBS) if inner == "wrist" and outer != "thumb"
]
"""Bones whose mean is the hand's axis: the thumb stands off it, and is placed least well."""

UNCERTAINTY = 0.2
"""Standard deviation of a bend that a landmark's own uncertainty causes: a knuckle lies 0.2 torso
lengths from the wrist, and a pose model places it to about a fifth of that. From 0.1 to 0.3 the
result is the same."""

LEAST_WEIGHT = 1e-6
"""Weight of a step at which the forearm lies as at the start: where no forearm ever turns, all
steps count alike."""


class WristBend:
    """How the wrist is bent during the stroke, whichever way the body leans.

    The sine of the angle from forearm to hand (positive: clockwise in the image), averaged over
    the steps of each arm. A step counts by the square of how far the forearm has turned, for a
    gesture's meaning lies in its stroke (Kendon 2004), times how long it looks, for one that points
    at the camera points nowhere. Two means differ by as much as they exceed what both
    vary by on the way and `UNCERTAINTY` (Welch 1947), so that a wrist that waves, or that is seen
    badly, has little to tell. Of two arms it is the root of the mean square; one that rests counts
    as little as it turns.

    Marshallers who turn a thumb up or down raise the same arm, and bend the wrist either way.
    """

    name = "wrist_bend"
    unit = "differences of the mean bend, in standard deviations of the bend on the way"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(3 A,)``: of each arm the mean bend, its standard deviation and its part.

        The part is in [0, 1], 1 for the arm whose forearm turns most. NaN for an arm whose forearm
        or hand was not seen.
        """
        steps = len(movement.limbs)
        arms = movement.limbs.reshape(steps, -1, len(LIMBS), 2)
        forearm, hand = arms[:, :, FOREARM], _mean_of_known(arms[:, :, HAND])
        length = _lengths(forearm)
        lengths = length * _lengths(hand)
        across = forearm[..., 0] * hand[..., 1] - forearm[..., 1] * hand[..., 0]
        bend = across / np.maximum(lengths, 1e-9)
        since = forearm - forearm[0]
        turned = np.einsum("nad,nad->na", since, since) * length
        turned[~np.isfinite(bend)] = 0.0
        weight = LEAST_WEIGHT + turned / max(turned.max(initial=0.0), 1e-12)
        total = weight.sum(axis=0)
        mean = (weight * bend).sum(axis=0) / total
        spread = np.sqrt((weight * (bend - mean) ** 2).sum(axis=0) / total)
        return np.column_stack([mean, spread, total / total.max(initial=LEAST_WEIGHT)]).ravel()

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return ``(M,)``; infinite where no arm is seen in both."""
        mean, spread, part = query.reshape(-1, 3).T
        means, spreads, parts = references.reshape(len(references), -1, 3).transpose(2, 0, 1)
        squares = (means - mean) ** 2 / (UNCERTAINTY**2 + spread**2 + spreads**2)
        known = np.isfinite(squares)
        weights = np.where(known, np.minimum(part, parts) ** 2, 0.0)
        total = (weights * np.where(known, squares, 0.0)).sum(axis=1)
        mean_square = np.divide(
            total, weights.sum(axis=1), out=np.full_like(total, np.inf), where=known.any(axis=1)
        )
        return np.asarray(np.sqrt(mean_square))


def _lengths(vectors: FloatArray) -> FloatArray:
    """Return the lengths of ``(N, A, 2)``."""
    return np.asarray(np.sqrt(np.einsum("nad,nad->na", vectors, vectors)))


def _mean_of_known(bones: FloatArray) -> FloatArray:
    """Average ``(N, A, B, 2)`` over the bones seen: ``(N, A, 2)``, NaN where none is."""
    known = np.isfinite(bones)
    if known.all():
        return np.asarray(bones.sum(axis=2) / bones.shape[2])
    total = np.where(known, bones, 0.0).sum(axis=2)
    count = known.sum(axis=2)
    mean: FloatArray = np.full_like(total, np.nan)
    np.divide(total, count, out=mean, where=count > 0)
    return mean
