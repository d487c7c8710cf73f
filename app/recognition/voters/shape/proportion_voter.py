"""Base class of shape voters whose descriptor is one number, a proportion of the drawing."""

from abc import abstractmethod

import numpy as np

from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.shape.shape_voter import ShapeVoter
from app.recognition.voters.voter import absolute_differences


class ProportionVoter(ShapeVoter):
    """Base of voters with one number as descriptor, compared by difference (paper, Sec. IV-D2)."""

    def length(self, keypoints: int) -> int:
        """Return the length of the descriptor, the same for any number of landmarks."""
        return 1

    def describe(self, drawing: Drawing) -> FloatArray:
        """Return the proportion, ``(1,)``."""
        return np.array([self.measure(drawing)])

    @abstractmethod
    def measure(self, drawing: Drawing) -> float:
        """Return the proportion of a drawing that has a stroke."""

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Return absolute differences, ``(G,)``."""
        return absolute_differences(query, references)
