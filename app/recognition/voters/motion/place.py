"""Voter `place`: where elbows and wrists are beside the body, aligned by DTW."""

from __future__ import annotations

import numpy as np

from app.recognition.features.motion import Movement
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.motion.motion_voter import DtwVoter


class Place(DtwVoter):
    """DTW distance between the places of elbows and wrists at equal times, in torso lengths.

    People differ in where they draw a figure, so that the voter gets no weight in a language of
    figures drawn at one place: there its between-class distance is below its within-class distance.
    """

    name = "place"
    unit = "mean distance along the alignment, in torso lengths"
    prior = 1.5
    within = 0.64
    between = 1.35

    def describe(self, movement: Movement) -> FloatArray:
        """Return ``(N, 2 A)`` places, NaN where not seen or where no torso is seen."""
        places = movement.places if movement.relative_to_body else movement.places * np.nan
        return np.asarray(places.reshape(len(places), -1))
