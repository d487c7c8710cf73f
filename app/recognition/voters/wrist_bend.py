"""Voter `wrist_bend`: the angle between forearm and hand."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from app.recognition.features.motion import LIMBS, Movement
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion_voters import MotionVoter

FOREARM = LIMBS.index(("elbow", "wrist"))
HAND = [
    index for index, (inner, outer) in enumerate(LIMBS) if inner == "wrist" and outer != "thumb"
]
"""Bones whose mean is the hand's axis: without the thumb, which is off it and detected worst."""

UNCERTAINTY = 0.2
"""Standard deviation of a bend caused by the landmarks' own error: a knuckle lies 0.2 torso lengths
from the wrist, and a pose model's error is about a fifth of that. From 0.1 to 0.3 the result is
the same."""

LEAST_WEIGHT = 1e-6
"""Weight of a step whose forearm points as at the start; if no forearm ever turns, all steps weigh
alike."""


class WristBend(MotionVoter):
    """Difference of the wrists' mean bend during the stroke, independent of the body's lean.

    The bend is the sine of the angle from forearm to hand (positive: clockwise in the image),
    averaged over the steps of each arm. A step's weight is the square of the forearm's turn from
    the start, because a gesture's meaning lies in its stroke (Kendon 2004), times the forearm's
    visible length, because one that points at the camera has no direction. The difference of two
    means is divided by their standard deviations and `UNCERTAINTY` together (Welch 1947), so that
    a waving or badly seen wrist counts little. Two arms give the root of the mean square, weighted
    by how far each turns.

    It separates aircraft marshallers' thumb up and thumb down, which raise the same arm.
    """

    name = "wrist_bend"
    unit = "differences of the mean bend, in standard deviations of the bend on the way"
    # Small: it helps marshalling only, and every demonstration bends the wrists, mostly without
    # meaning.
    prior = 0.25
    within = 0.45
    between = 0.58

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(3 A,)``: of each arm the mean bend, its standard deviation and its share.

        The share is in [0, 1], 1 for the arm whose forearm turns most. NaN for an arm whose
        forearm or hand was not seen.
        """
        # As complex numbers x + jy: one product gives the sine and both lengths.
        limbs = np.ascontiguousarray(movement.limbs).view(np.complex128)
        arms = limbs.reshape(len(limbs), -1, len(LIMBS))
        forearm, hand = arms[..., FOREARM], _mean_of_known(arms[..., HAND])
        across = forearm.conj() * hand
        bend = across.imag / np.maximum(np.abs(across), 1e-9)
        since = forearm - forearm[0]
        turned = (since.real**2 + since.imag**2) * np.abs(forearm)
        turned[np.isnan(bend)] = 0.0
        weight = LEAST_WEIGHT + turned / max(turned.max(initial=0.0), 1e-12)
        total = np.add.reduce(weight)
        mean = np.add.reduce(weight * bend) / total
        spread = np.sqrt(np.add.reduce(weight * (bend - mean) ** 2) / total)
        part = total / total.max(initial=LEAST_WEIGHT)
        return np.array([mean, spread, part]).T.ravel()

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return ``(M,)``; infinite where no arm is seen in both."""
        mean, spread, part = query.reshape(-1, 3).T
        means, spreads, parts = references.reshape(len(references), -1, 3).transpose(2, 0, 1)
        squares = (means - mean) ** 2 / (UNCERTAINTY**2 + spread**2 + spreads**2)
        known = np.isfinite(squares)
        weights = np.minimum(part, parts) ** 2
        if known.size and known.all():
            total, weight = np.add.reduce(weights * squares, axis=1), np.add.reduce(weights, axis=1)
            return np.asarray(np.sqrt(total / weight))
        weights[~known] = 0.0
        total = (weights * np.where(known, squares, 0.0)).sum(axis=1)
        mean_square = np.divide(
            total, weights.sum(axis=1), out=np.full_like(total, np.inf), where=known.any(axis=1)
        )
        return np.asarray(np.sqrt(mean_square))


def _mean_of_known(bones: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """Average ``(N, A, B)`` over the bones that are seen: ``(N, A)``, NaN where none is."""
    known = np.isfinite(bones)
    total = np.add.reduce(np.where(known, bones, 0.0), axis=2)
    count = np.add.reduce(known, axis=2, dtype=np.float64)
    count[count == 0] = np.nan
    return np.asarray(total * (1.0 / count))
