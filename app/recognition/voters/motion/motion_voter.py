"""Voters that follow the movement itself: where, which way, in what posture, how fast."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Protocol

import numpy as np

from app.recognition.features.motion import LIMBS, Movement, sized
from app.recognition.matching.dtw import ElasticReferences
from app.recognition.matching.step_distances import ROUNDING, StepReferences
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.base import absolute_differences, euclidean_distances
from app.recognition.voters.wrist_bend import WristBend

BAND = 8
"""Steps of 32 that one movement may be ahead of the other: a quarter, the radius at which accuracy
on drawn figures levels off; without a bound, a loop could be matched to a corner."""

RESTING_WEIGHT = 0.3
"""Weight of a posture at the place where the movement starts; at the farthest place it is 1 more.
From 0.2 to 0.5 the result is the same."""

HAND_BONES = [index for index, (inner, _) in enumerate(LIMBS) if inner == "wrist"]
"""Bones beyond the wrist, of each arm's."""

SHORTEST_SECONDS = 0.05
"""Shortest duration taken seriously, two frames: a logarithm needs a floor."""


SHORTEST_LENGTH = 1.0
"""Shortest way taken seriously, in sizes: a straight stroke is three and a half of its sizes long,
and only what does not move is shorter."""


class MotionVoter(Protocol):
    """Judges how much a query moves like each reference, from one point of view."""

    @property
    def name(self) -> str:
        """The name in results, in snake_case."""
        ...

    @property
    def unit(self) -> str:
        """What a distance of 1 means, for people."""
        ...

    def describe(self, movement: Movement) -> FloatArray:
        """Describe a movement by an array whose shape is the same for all of a language."""
        ...

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Measure ``(M,)``, >= 0, how far the query lies from each of the stacked references."""
        ...


class ElasticVoter:
    """A voter that aligns two movements step by step, and so can be asked together with others."""

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return the elastic distances, ``(M,)``; infinite where nothing can be compared."""
        return ElasticReferences(references, BAND).distances(query)


class UnorderedVoter(ABC):
    """A voter to whom a movement is the same in whatever order its steps are taken."""

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """As of every `MotionVoter`."""
        return self.distances_to(query, StepReferences(references))

    @abstractmethod
    def distances_to(self, query: FloatArray, references: StepReferences) -> FloatArray:
        """Measure the same, of references that were prepared."""


class Path(ElasticVoter):
    """Elastic distance between the paths, free of place and size (Sakoe and Chiba 1978).

    Each landmark's path is relative to its own mean; all are divided by one size, the root of the
    mean over the steps of the summed squares. ``1/N sum |q - r|^2`` along the best alignment.
    """

    name = "path"
    unit = "mean squared distance along the alignment, in squared sizes of the gesture"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 L)`` coordinates in sizes."""
        return movement.figure.reshape(len(movement.paths), -1)


class Direction(ElasticVoter):
    """Elastic distance between the directions of travel (Taranta et al. 2017, Jackknife).

    The joint unit vector of all landmarks' velocities at equal steps: of no size, so that small
    details count as much as large ones.
    """

    name = "direction"
    unit = "mean squared difference of unit vectors along the alignment, at most 4 a step"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 L)`` joint unit vectors."""
        paths = movement.paths
        steps = np.empty_like(paths)
        steps[1:-1] = (paths[2:] - paths[:-2]) / 2
        steps[0], steps[-1] = paths[1] - paths[0], paths[-1] - paths[-2]
        flat = steps.reshape(len(steps), -1)
        length = np.sqrt(np.vecdot(flat, flat))
        return np.asarray(flat / (length + 1e-9)[:, None])


class Posture(ElasticVoter):
    """Elastic distance between the arms' postures: where the bones point, step by step.

    Vectors along upper arm, forearm, hand and thumb, divided by one size. Unlike a path they tell
    a raised hand from a lowered one. Steps count from `RESTING_WEIGHT` at the starting place to
    more at the farthest one: a gesture's meaning lies in its stroke, not in how the arm rests
    before and after (Kendon 2004).
    """

    name = "posture"
    unit = "mean squared difference of the limbs along the alignment, in squared sizes"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 B)`` vectors in sizes, NaN where not seen; ``(N, 0)`` without limbs."""
        weight = RESTING_WEIGHT + movement.under_way
        return (sized(movement.limbs) * weight[:, None, None]).reshape(len(weight), -1)


class HandAttitude(ElasticVoter):
    """Elastic distance between the hands' attitudes: where fingers and thumb point (as `Posture`).

    Only the bones beyond the wrist, divided by their own size, and only under way: a thumb up
    against a thumb down is small beside the arm that raises it.
    """

    name = "hand_attitude"
    unit = "mean squared difference of the hands' bones along the alignment, in squared sizes"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 B')`` vectors in sizes, NaN where not seen."""
        steps = len(movement.limbs)
        arms = movement.limbs.reshape(steps, -1, len(LIMBS), 2)
        hands = arms.take(HAND_BONES, axis=2).reshape(steps, -1, 2)
        return (sized(hands) * movement.under_way[:, None, None]).reshape(steps, -1)


class Cloud(UnorderedVoter):
    """Distance between the figures as clouds of points, whatever the order ($P, Vatavu 2012).

    The mean distance of each step of either figure to the nearest step of the other one
    (chamfer distance, Barrow et al. 1977).
    """

    name = "cloud"
    unit = "mean distance to the nearest step of the other figure, in sizes"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 L)`` coordinates in sizes."""
        return movement.figure.reshape(len(movement.paths), -1)

    def distances_to(self, query: FloatArray, references: StepReferences) -> FloatArray:
        """Return the chamfer distances, ``(M,)``."""
        squares = references.squared_distances(query)
        # Turned before: along the first axis numpy finds the least in a fifth of the time.
        turned = np.ascontiguousarray(squares.swapaxes(0, 1))
        nearest = np.concatenate([turned.min(axis=0), squares.min(axis=0)])
        nearest[nearest < ROUNDING] = 0.0
        return np.asarray(np.add.reduce(np.sqrt(nearest)) / len(nearest), dtype=np.float64)


class StrokeDirection:
    """Which way the stroke goes: its sense of rotation, and from where to where.

    Signed area (positive: clockwise in the image) in squared sizes, and the way from start to end
    in sizes, of each landmark: left against right, clockwise against counter-clockwise.
    """

    name = "stroke_direction"
    unit = "sizes between the ends, squared sizes between the signed areas"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(3 L,)``: per landmark the signed area, then x and y of the way."""
        paths = movement.figure
        before, after = paths[:-1], paths[1:]
        cross = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
        way = paths[-1] - paths[0]
        return np.concatenate([np.add.reduce(cross)[:, None] / 2, way], axis=1).ravel()

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return Euclidean distances, ``(M,)``."""
        return euclidean_distances(query, references)


class WhichHand:
    """Which landmarks move: each one's share of the motion, as a unit vector."""

    name = "which_hand"
    unit = "distance between unit vectors of the landmarks' shares, at most sqrt 2"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(L,)``: each landmark's root mean square, together of norm 1."""
        paths = movement.paths
        squares = np.add.reduce(np.vecdot(paths, paths))
        return np.asarray(np.sqrt(squares / max(squares.sum(), 1e-18)))

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return Euclidean distances, ``(M,)``."""
        return euclidean_distances(query, references)


class PathLength:
    """How long the way is, for its size: a line against a zigzag (Rubine 1991, total length).

    The joint path of all landmarks, in sizes.
    """

    name = "path_length"
    unit = "doublings of the length in sizes"

    def describe(self, movement: Movement) -> FloatArray:
        """Return the logarithm to base 2 of the length, ``(1,)``."""
        figure = movement.figure.reshape(len(movement.figure), -1)
        steps = figure[1:] - figure[:-1]
        length = float(np.sqrt(np.vecdot(steps, steps)).sum())
        return np.log2([max(length, SHORTEST_LENGTH)])

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return absolute differences, ``(M,)``."""
        return absolute_differences(query, references)


class Tempo:
    """How long the movement takes."""

    name = "tempo"
    unit = "doublings of the duration"

    def describe(self, movement: Movement) -> FloatArray:
        """Return the logarithm to base 2 of the seconds, ``(1,)``."""
        return np.log2([max(movement.duration, SHORTEST_SECONDS)])

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return absolute differences, ``(M,)``."""
        return absolute_differences(query, references)


MOTION_VOTERS: tuple[MotionVoter, ...] = (
    Path(),
    Direction(),
    Posture(),
    HandAttitude(),
    WristBend(),
    Cloud(),
    StrokeDirection(),
    WhichHand(),
    PathLength(),
    Tempo(),
)
"""The voters of profile ``full`` beside the paper's seven."""
