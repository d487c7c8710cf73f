"""Voter `cloud`: the figure as a point cloud, independent of the order of its steps."""

from __future__ import annotations

import numpy as np

from app.recognition.features.motion import Movement
from app.recognition.matching.step_distances import ROUNDING, StepReferences
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import UnorderedVoter


class Cloud(UnorderedVoter):
    """Distance between the figures as point clouds, without order ($P, Vatavu 2012).

    The mean distance of each step of either figure to the nearest step of the other one
    (chamfer distance, Barrow et al. 1977).
    """

    name = "cloud"
    unit = "mean distance to the nearest step of the other figure, in sizes"
    prior = 0.0
    within = 0.18
    between = 0.43

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 L)`` coordinates in sizes."""
        return movement.figure.reshape(len(movement.paths), -1)

    def distances_to(self, query: FloatArray, references: StepReferences) -> FloatArray:
        """Return the chamfer distances, ``(M,)``."""
        squares = references.squared_distances(query)
        # Transposed first: numpy's minimum along the first axis takes a fifth of the time.
        turned = np.ascontiguousarray(squares.swapaxes(0, 1))
        nearest = np.concatenate([turned.min(axis=0), squares.min(axis=0)])
        nearest[nearest < ROUNDING] = 0.0
        return np.asarray(np.add.reduce(np.sqrt(nearest)) / len(nearest), dtype=np.float64)
