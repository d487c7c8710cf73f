"""A matcher in the manner of Jackknife (Taranta et al. 2017), written from the paper.

Sixteen points and the fifteen directions between them are compared by dynamic time warping, with
one minus the inner product as its cost and a band of two. Two factors correct the distance: the
length that each coordinate travels, and its range. The rejection threshold is left out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.recognition import PoseSequence
from app.recognition.matching.dtw import dtw_distances
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from benchmarks.methods.base import NearestDemonstration
from benchmarks.methods.steps import even_positions

POINTS = 16
BAND = 2


class Jackknife(NearestDemonstration):
    """The corrected distance."""

    def describe(self, demonstrations: Sequence[PoseSequence]) -> None:
        """Keep directions and corrections."""
        described = zip(*map(_describe, demonstrations), strict=True)
        self._directions, self._corrections = map(np.array, described)

    def measure(self, take: PoseSequence) -> FloatArray:
        """Return the corrected distances ``(N,)``."""
        directions, corrections = _describe(take)
        # The squared distance of unit vectors is twice (one minus the inner product).
        warped = dtw_distances(directions, self._directions, BAND) / 2
        alike = np.einsum("gcd,cd->gc", self._corrections, corrections)
        return np.asarray(warped * (1 / np.maximum(alike, 1e-9)).prod(axis=1))


def _describe(poses: PoseSequence) -> tuple[FloatArray, FloatArray]:
    """Return ``(15, D)`` unit directions, and ``(2, D)`` unit vectors: travelled, and reached."""
    points = even_positions(Trajectory.from_poses(poses), POINTS).reshape(POINTS, -1)
    steps = np.diff(points, axis=0)
    corrections = np.stack([np.abs(steps).sum(axis=0), np.ptp(points, axis=0)])
    return _unit(steps), _unit(corrections)


def _unit(rows: FloatArray) -> FloatArray:
    return np.asarray(rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-9))
