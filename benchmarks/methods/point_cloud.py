"""The $P recogniser: gestures as clouds of points, whatever the order (Vatavu et al. 2012).

$Q (Vatavu et al. 2018) is the same matching with early abandoning on coarser points: faster for a
large language, but not more accurate, so $P stands for both. The points of several landmarks at one
moment are combined into one point with more dimensions.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.recognition import PoseSequence
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from benchmarks.methods.base import NearestDemonstration
from benchmarks.methods.steps import STEPS, even_positions

STARTS_EXPONENT = 0.5
"""Exponent of the number of starting points, as published."""


class PointCloud(NearestDemonstration):
    """The cheapest greedy matching of two clouds, either way round."""

    def describe(self, demonstrations: Sequence[PoseSequence]) -> None:
        """Keep the points."""
        self._clouds = [_cloud(each) for each in demonstrations]

    def measure(self, take: PoseSequence) -> FloatArray:
        """Return the costs ``(N,)`` of the matchings."""
        cloud = _cloud(take)
        return np.array([greedy_cloud_distance(cloud, other) for other in self._clouds])


def greedy_cloud_distance(one: FloatArray, other: FloatArray) -> float:
    """Return the cheapest greedy matching of two clouds ``(N, D)`` from several starts."""
    apart = np.linalg.norm(one[:, None] - other[None], axis=2)
    step = int(len(one) ** STARTS_EXPONENT)
    starts = range(0, len(one), step)
    return min(_match(costs, start) for costs in (apart, apart.T) for start in starts)


def _match(costs: FloatArray, start: int) -> float:
    """Match each point with the nearest unmatched one; early matches weigh most."""
    left = costs.copy()
    total = 0.0
    for rank, row in enumerate(np.roll(np.arange(len(costs)), -start)):
        nearest = int(left[row].argmin())
        total += (1 - rank / len(costs)) * left[row, nearest]
        left[:, nearest] = np.inf
    return float(total)


def _cloud(poses: PoseSequence) -> FloatArray:
    return even_positions(Trajectory.from_poses(poses)).reshape(STEPS, -1)
