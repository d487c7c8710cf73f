"""Voter `stroke_direction`: the sense of rotation and the vector from start to end."""

from __future__ import annotations

import numpy as np

from app.recognition.features.motion import Movement
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import MotionVoter
from app.recognition.voters.voter import euclidean_distances


class StrokeDirection(MotionVoter):
    """Difference of the sense of rotation and of the vector from start to end.

    Of each landmark the signed area (positive: clockwise in the image) in squared sizes, and the
    vector from start to end in sizes: separates clockwise from counter-clockwise, left from right.
    """

    name = "stroke_direction"
    unit = "sizes between the ends, squared sizes between the signed areas"
    prior = 0.0
    within = 0.35
    between = 2.5

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(3 L,)``: per landmark the signed area, then x and y from start to end."""
        paths = movement.figure
        before, after = paths[:-1], paths[1:]
        cross = before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0]
        way = paths[-1] - paths[0]
        return np.concatenate([np.add.reduce(cross)[:, None] / 2, way], axis=1).ravel()

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return Euclidean distances, ``(M,)``."""
        return euclidean_distances(query, references)
