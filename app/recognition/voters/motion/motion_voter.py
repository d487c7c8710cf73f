"""Base classes of motion voters: aligned by DTW, or with one descriptor."""

from __future__ import annotations

from abc import abstractmethod

from app.recognition.features.motion import Movement
from app.recognition.matching.dtw import BAND, OPEN_ENDS, DtwReferences
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.voter import Voter


class MotionVoter(Voter):
    """Base of voters that compare a query's movement with each gesture's."""

    @abstractmethod
    def describe(self, movement: Movement) -> FloatArray:
        """Return the descriptor of a movement: of one shape for all gestures of a language."""


class DtwVoter(MotionVoter):
    """Base of voters that align two movements step by step by dynamic time warping (DTW).

    All of them are computed together, which costs hardly more than one.
    """

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return the DTW distances, ``(M,)``; infinite where nothing can be compared."""
        return DtwReferences(references, BAND, OPEN_ENDS).distances(query)
