"""Voter `path_length`: the length of the path relative to its size."""

from __future__ import annotations

import numpy as np

from app.recognition.features.motion import Movement
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import MotionVoter
from app.recognition.voters.voter import Cue, absolute_differences

SHORTEST_LENGTH = 1.0
"""Shortest length, in sizes; a straight stroke has 3.5, so only a movement at rest is shorter."""


class PathLength(MotionVoter):
    """Difference of path lengths relative to size: line or zigzag (Rubine 1991, total length).

    The joint path of all landmarks, in sizes.
    """

    name = "path_length"
    unit = "doublings of the length in sizes"
    prior = 0.0
    within = 0.11
    between = 0.28
    cue = Cue("length", weight=1.0, reach=7.0, squared=False, varies_by_gesture=False)

    def describe(self, movement: Movement) -> FloatArray:
        """Return the logarithm to base 2 of the length, ``(1,)``."""
        figure = movement.figure.reshape(len(movement.figure), -1)
        steps = figure[1:] - figure[:-1]
        length = float(np.sqrt(np.vecdot(steps, steps)).sum())
        return np.log2([max(length, SHORTEST_LENGTH)])

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return absolute differences, ``(M,)``."""
        return absolute_differences(query, references)
