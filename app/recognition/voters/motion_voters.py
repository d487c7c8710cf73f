"""Motion voters: compare the movements of two takes.

`velocity`, `place`, `path` and `second_opinion` align them by DTW, `tempo` compares their durations
and `wrist_bend` the mean angle between forearm and hand.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.features.motion import LIMBS, Movement, central_differences, normalize_size
from app.recognition.matching.dtw import BAND, OPEN_ENDS, DtwReferences
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.voter import WeightedVoter, absolute_differences

SLOW: Final = 0.3
"""Speed, as a share of the usual one, at which a step counts half as much as a fast one. From 0.1
to 0.5 the accuracy is the same; with plain velocities it is 3 points lower
(`benchmarks/studies/people.md`)."""

SHORTEST_SECONDS: Final = 0.05
"""Lower limit of durations, two frames, for the logarithm."""


class MotionVoter(WeightedVoter):
    """Base of voters that compare a query's movement with each gesture's."""

    @abstractmethod
    def describe(self, movement: Movement) -> FloatArray:
        """Return the descriptor of a movement: of one shape for all gestures of a language."""


class DtwVoter(MotionVoter):
    """Base of voters that align two movements step by step by dynamic time warping (DTW).

    All of them are computed together, which costs hardly more than one.
    """

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return the DTW distances, ``(M,)``; infinite where nothing can be compared."""
        return DtwReferences(references, BAND, OPEN_ENDS).distances(query)


class Velocity(DtwVoter):
    """DTW distance between the velocities of elbows and wrists at equal times.

    A velocity v is divided by ``|v| + SLOW`` of the root of the mean square, so that its direction
    counts at any speed but that of rest: between a velocity, of which most people keep the order of
    fast and slow steps only, and Jackknife's unit vectors (Taranta et al. 2017), of which the sway
    at rest is as long as a stroke.
    """

    name = "velocity"
    unit = "mean difference along the alignment, of compressed velocities below 1"
    prior = 1.0
    within = 0.0
    between = 0.6

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 A)`` compressed velocities, NaN where not seen."""
        steps = normalize_size(central_differences(movement.places)).reshape(
            len(movement.places), -1
        )
        known = np.nan_to_num(steps)
        speed = np.sqrt(np.vecdot(known, known))
        return np.asarray(steps / (speed + SLOW)[:, None])


class Place(DtwVoter):
    """DTW distance between the places of elbows and wrists at equal times, in torso lengths.

    People differ in where they draw a figure, so that the voter gets no weight in a language of
    figures drawn at one place: there its between-class distance is below its within-class distance.
    """

    name = "place"
    unit = "mean distance along the alignment, in torso lengths"
    prior = 1.5
    within = 0.64
    between = 1.35

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 A)`` places, NaN where not seen or where no torso is seen."""
        places = movement.places if movement.relative_to_body else movement.places * np.nan
        return np.asarray(places.reshape(len(places), -1))


class Path(DtwVoter):
    """DTW distance between the paths, independent of position and size (Sakoe and Chiba 1978).

    Each landmark's path is relative to its own mean; all are divided by one size, the root of the
    mean over the steps of the summed squares. ``1/N sum |q - r|`` along the best alignment.

    It has weight where hands alone are seen: the paths of whole arms differ between bodies
    (`benchmarks/studies/people.md`).
    """

    name = "path"
    unit = "mean distance along the alignment, in sizes of the gesture"
    prior = 0.5
    within = 0.0
    between = 0.67

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 L)`` coordinates in sizes."""
        return movement.figure.reshape(len(movement.paths), -1)

    def prior_for(self, *, arms: bool) -> float:
        """Return the prior where hands alone are seen, otherwise 0."""
        return 0.0 if arms else self.prior


class Tempo(MotionVoter):
    """Difference of durations."""

    name = "tempo"
    unit = "doublings of the duration"
    prior = 0.0
    within = 0.38
    between = 0.5
    weight_where_needed = 0.3
    """Amount added to the score per doubling of the duration, for a gesture whose tempo counts:
    more than the distance of two takes (0.1), less than that of two gestures (1)."""

    def describe(self, movement: Movement) -> FloatArray:
        """Return the logarithm to base 2 of the seconds, ``(1,)``."""
        return np.log2([max(movement.duration, SHORTEST_SECONDS)])

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return absolute differences, ``(M,)``."""
        return absolute_differences(query, references)


class SecondOpinion(DtwVoter):
    """DTW distance between the directions in which elbows and wrists go, at steps of equal way.

    A second way of comparing, which knows neither speed nor place: of both arms together, relative
    to the torso of the same moment, only where they go next, as a unit vector. It is no part of the
    weighted mean: `fusion.add_second_opinion` says how it counts. It abstains where no torso, or
    not both arms are seen.
    """

    name = "second_opinion"
    unit = "difference of directions, as a share of that of two gestures"
    prior = 0.0
    within = 0.0
    between = 0.7

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 8)`` unit vectors; all NaN where it abstains."""
        ways = movement.ways.reshape(len(movement.ways), -1)
        # The last step goes on as the one before.
        steps = np.diff(ways, axis=0, append=2 * ways[-1:] - ways[-2:-1])
        if not movement.relative_to_body or np.isnan(steps).any():
            return np.full(steps.shape, np.nan)
        return np.asarray(steps / np.maximum(np.sqrt(np.vecdot(steps, steps)), 1e-9)[:, None])


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
