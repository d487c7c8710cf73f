"""The bases of voters that compare movements: aligned by DTW, unordered, or by one descriptor."""

from __future__ import annotations

from abc import abstractmethod

from app.recognition.features.motion import Movement
from app.recognition.matching.dtw import DtwReferences
from app.recognition.matching.step_distances import StepReferences
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.voter import Voter

BAND = 8
"""Steps of 32 that one movement may be ahead of the other (Sakoe-Chiba band): a quarter, the radius
at which accuracy on drawn figures levels off; without it, a loop could match a corner."""


class MotionVoter(Voter):
    """A voter that compares a query's movement with each gesture's."""

    @abstractmethod
    def describe(self, movement: Movement) -> FloatArray:
        """Describe a movement by an array whose shape is the same for all of a language."""


class DtwVoter(MotionVoter):
    """A voter that aligns two movements step by step by dynamic time warping (DTW).

    All of them are asked together, which costs hardly more than one.
    """

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return the DTW distances, ``(M,)``; infinite where nothing can be compared."""
        return DtwReferences(references, BAND).distances(query)


class UnorderedVoter(MotionVoter):
    """A voter whose distance does not depend on the order of the steps."""

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return the distances, ``(M,)``."""
        return self.distances_to(query, StepReferences(references))

    @abstractmethod
    def distances_to(self, query: FloatArray, references: StepReferences) -> FloatArray:
        """Return the distances to references that were prepared, ``(M,)``."""
