"""Voter `velocity`: the velocities of the arms' joints in time, aligned by DTW."""

from __future__ import annotations

from typing import Final

import numpy as np

from app.recognition.features.motion import Movement, central_differences, normalize_size
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import DtwVoter

SLOW: Final = 0.3
"""Speed, as a share of the usual one, at which a step counts half as much as a fast one. From 0.1
to 0.5 the accuracy is the same; with plain velocities it is 3 points lower
(`benchmarks/studies/people.md`)."""


class Velocity(DtwVoter):
    """DTW distance between the velocities of elbows and wrists at equal times.

    A velocity v is divided by ``|v| + SLOW`` of the root of the mean square, so that its direction
    counts at any speed but that of rest: between a velocity, of which most people keep the order of
    fast and slow steps only, and Jackknife's unit vectors (Taranta et al. 2017), of which the sway
    at rest is as long as a stroke.
    """

    name = "velocity"
    unit = "mean difference along the alignment, of compressed velocities below 1"
    prior = 1.0
    within = 0.0
    between = 0.6

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 A)`` compressed velocities, NaN where not seen."""
        steps = normalize_size(central_differences(movement.places)).reshape(
            len(movement.places), -1
        )
        known = np.nan_to_num(steps)
        speed = np.sqrt(np.vecdot(known, known))
        return np.asarray(steps / (speed + SLOW)[:, None])
