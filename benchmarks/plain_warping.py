"""Plain dynamic time warping, the yardstick: position and direction of all landmarks together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.recognition import PoseError, PoseSequence
from app.recognition.elastic import elastic_distances
from app.recognition.poses import FloatArray
from app.recognition.trajectory import Trajectory

STEPS = 32
BAND = 8


class PlainWarping:
    """Answers the reference with the least sum of two warped distances, each over its median.

    Paths of all landmarks are resampled to 32 steps of equal length; positions are centred and
    scaled together, directions are joint unit vectors.
    """

    def __init__(self, references: Sequence[PoseSequence], labels: Sequence[str]) -> None:
        self._labels = list(labels)
        described = [_described(poses) for poses in references]
        self._references = [np.array(view) for view in zip(*described, strict=True)]
        own = np.array([self._distances(each) for each in described])
        self._medians = np.median(own[~np.eye(len(own), dtype=bool)], axis=0)

    def answer(self, poses: PoseSequence) -> str:
        """Return the label of the nearest reference."""
        distances = self._distances(_described(poses)) / self._medians
        return self._labels[int(distances.sum(axis=1).argmin())]

    def _distances(self, query: tuple[FloatArray, FloatArray]) -> FloatArray:
        pairs = zip(query, self._references, strict=True)
        return np.stack([elastic_distances(q, r, BAND) for q, r in pairs], axis=1)


def _described(poses: PoseSequence) -> tuple[FloatArray, FloatArray]:
    even = Trajectory.from_poses(poses).filled(np.inf).resampled_in_arc_length(STEPS).xy
    if not np.isfinite(even).all():
        raise PoseError("plain warping needs every landmark in every frame")
    positions = even - even.mean(axis=(0, 1))
    positions = positions / np.sqrt((positions**2).sum(axis=(1, 2)).mean())
    steps = np.gradient(positions, axis=0)
    steps = steps / (np.sqrt((steps**2).sum(axis=(1, 2), keepdims=True)) + 1e-9)
    return positions.reshape(STEPS, -1), steps.reshape(STEPS, -1)
