"""Plain dynamic time warping, the baseline: position and direction of all landmarks together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.recognition import PoseSequence
from app.recognition.matching.dtw import dtw_distances
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from benchmarks.methods.base import NearestDemonstration
from benchmarks.methods.steps import directions, even_positions

BAND = 8
"""Band of DTW, in steps of 32."""


class PlainWarping(NearestDemonstration):
    """The sum of two warped distances, each over its median between demonstrations."""

    def describe(self, demonstrations: Sequence[PoseSequence]) -> None:
        """Find the median of each distance between the demonstrations."""
        self._references = [_describe(each) for each in demonstrations]
        own = np.array([self._distances(each) for each in self._references])
        self._medians = np.median(own[~np.eye(len(own), dtype=bool)], axis=0)

    def measure(self, take: PoseSequence) -> FloatArray:
        """Return the sums ``(N,)``."""
        return np.asarray((self._distances(_describe(take)) / self._medians).sum(axis=1))

    def _distances(self, query: list[FloatArray]) -> FloatArray:
        """Return ``(G, 2)``."""
        views = zip(query, zip(*self._references, strict=True), strict=True)
        return np.stack([dtw_distances(q, np.array(r), BAND) for q, r in views], axis=1)


def _describe(poses: PoseSequence) -> list[FloatArray]:
    positions = even_positions(Trajectory.from_poses(poses))
    steps = len(positions)
    return [positions.reshape(steps, -1), directions(positions).reshape(steps, -1)]
