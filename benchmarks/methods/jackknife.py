"""A matcher in the manner of Jackknife (Taranta et al. 2017), written from the paper.

Sixteen points and the fifteen directions between them are compared by dynamic time warping, with
one minus the inner product as its cost and a band of two. Two factors correct the distance: the
length that each coordinate travels, and its range. The rejection threshold is left out.
"""

from __future__ import annotations

import numpy as np

from app.recognition import PoseSequence
from app.recognition.matching.dtw import dtw_distances
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from benchmarks.methods.base import Method
from benchmarks.methods.steps import even_positions

POINTS = 16
BAND = 2


class Jackknife(Method):
    """Answers the reference with the least corrected distance."""

    def __init__(self) -> None:
        self._labels: list[str] = []
        self._directions: list[FloatArray] = []
        self._corrections: list[FloatArray] = []

    def add(self, label: str, demonstration: PoseSequence) -> None:
        """Describe the demonstration."""
        self._labels.append(label)
        directions, corrections = _describe(demonstration)
        self._directions.append(directions)
        self._corrections.append(corrections)

    def answer(self, query: PoseSequence) -> str:
        """Return the label of the nearest reference."""
        directions, corrections = _describe(query)
        # The squared distance of unit vectors is twice (one minus the inner product).
        warped = dtw_distances(directions, np.array(self._directions), BAND) / 2
        alike = np.einsum("gcd,cd->gc", np.array(self._corrections), corrections)
        factors = 1 / np.maximum(alike, 1e-9)
        return self._labels[int((warped * factors.prod(axis=1)).argmin())]


def _describe(poses: PoseSequence) -> tuple[FloatArray, FloatArray]:
    """Return ``(15, D)`` unit directions, and ``(2, D)`` unit vectors: travelled, and reached."""
    points = even_positions(Trajectory.from_poses(poses), POINTS).reshape(POINTS, -1)
    steps = np.diff(points, axis=0)
    corrections = np.stack([np.abs(steps).sum(axis=0), np.ptp(points, axis=0)])
    return _unit(steps), _unit(corrections)


def _unit(rows: FloatArray) -> FloatArray:
    return np.asarray(rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-9))
