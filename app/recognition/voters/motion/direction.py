"""Voter `direction`: the direction of travel at each step, aligned by DTW."""

from __future__ import annotations

import numpy as np

from app.recognition.features.motion import Movement, central_differences
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import DtwVoter


class Direction(DtwVoter):
    """DTW distance between the directions of travel (Taranta et al. 2017, Jackknife).

    The descriptor is the joint unit vector of all landmarks' velocities at equal steps. Without
    size, small details count as much as large ones.
    """

    name = "direction"
    unit = "mean squared difference of unit vectors along the alignment, at most 4 a step"
    prior = 0.25
    within = 0.14
    between = 1.3
    cue = "movement"

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 L)`` joint unit vectors."""
        flat = central_differences(movement.paths.reshape(len(movement.paths), -1))
        length = np.sqrt(np.vecdot(flat, flat))
        return np.asarray(flat / (length + 1e-9)[:, None])

    def prior_for(self, landmarks: int) -> float:
        """Return the prior divided by the number of landmarks.

        The joint direction of many landmarks is mostly the sway of those at rest.
        """
        return self.prior / landmarks
