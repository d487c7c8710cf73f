"""The $P recogniser: gestures as clouds of points, whatever the order (Vatavu et al. 2012).

$Q (Vatavu et al. 2018) is the same matching with early abandoning on coarser points: faster for a
large language, but not more accurate, so $P stands for both. The points of several landmarks at one
moment are combined into one point with more dimensions.
"""

from __future__ import annotations

import numpy as np

from app.recognition import PoseSequence
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from benchmarks.methods.base import Method
from benchmarks.methods.steps import STEPS, even_positions

STARTS_EXPONENT = 0.5
"""Exponent of the number of starting points, as published."""


class PointCloud(Method):
    """Answers the cloud with the cheapest greedy matching, either way round."""

    def __init__(self) -> None:
        self._labels: list[str] = []
        self._clouds: list[FloatArray] = []

    def add(self, label: str, demonstration: PoseSequence) -> None:
        """Keep the demonstration's points."""
        self._labels.append(label)
        self._clouds.append(_cloud(demonstration))

    def answer(self, query: PoseSequence) -> str:
        """Return the label of the nearest cloud."""
        cloud = _cloud(query)
        distances = [greedy_cloud_distance(cloud, other) for other in self._clouds]
        return self._labels[int(np.argmin(distances))]


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
