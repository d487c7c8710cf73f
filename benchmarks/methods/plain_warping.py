"""Plain dynamic time warping, the baseline: position and direction of all landmarks together."""

from __future__ import annotations

import numpy as np

from app.recognition import PoseSequence
from app.recognition.matching.dtw import dtw_distances
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from benchmarks.methods.base import Method
from benchmarks.methods.steps import directions, even_positions

BAND = 8
"""Band of DTW, in steps of 32."""


class PlainWarping(Method):
    """Answers the reference with the least sum of two warped distances, each over its median."""

    def __init__(self) -> None:
        self._labels: list[str] = []
        self._references: list[list[FloatArray]] = []
        self._medians = np.ones(2)

    def add(self, label: str, demonstration: PoseSequence) -> None:
        """Describe the demonstration."""
        self._labels.append(label)
        self._references.append(_describe(demonstration))

    def prepare(self) -> None:
        """Find the median of each distance between the gestures."""
        own = np.array([self._distances(each) for each in self._references])
        self._medians = np.median(own[~np.eye(len(own), dtype=bool)], axis=0)

    def answer(self, query: PoseSequence) -> str:
        """Return the label of the nearest reference."""
        distances = self._distances(_describe(query)) / self._medians
        return self._labels[int(distances.sum(axis=1).argmin())]

    def _distances(self, query: list[FloatArray]) -> FloatArray:
        """Return ``(G, 2)``."""
        views = zip(query, zip(*self._references, strict=True), strict=True)
        return np.stack([dtw_distances(q, np.array(r), BAND) for q, r in views], axis=1)


def _describe(poses: PoseSequence) -> list[FloatArray]:
    positions = even_positions(Trajectory.from_poses(poses))
    steps = len(positions)
    return [positions.reshape(steps, -1), directions(positions).reshape(steps, -1)]
