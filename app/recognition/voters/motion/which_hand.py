"""Voter `which_hand`: the share of each landmark in the motion."""

from __future__ import annotations

import numpy as np

from app.recognition.features.motion import Movement
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import MotionVoter
from app.recognition.voters.voter import euclidean_distances


class WhichHand(MotionVoter):
    """Difference of the landmarks' shares in the motion, as unit vectors."""

    name = "which_hand"
    unit = "distance between unit vectors of the landmarks' shares, at most sqrt 2"
    prior = 0.0
    within = 0.05
    between = 0.5

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(L,)``: each landmark's root mean square, together of norm 1."""
        paths = movement.paths
        squares = np.add.reduce(np.vecdot(paths, paths))
        return np.asarray(np.sqrt(squares / max(squares.sum(), 1e-18)))

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return Euclidean distances, ``(M,)``."""
        return euclidean_distances(query, references)
