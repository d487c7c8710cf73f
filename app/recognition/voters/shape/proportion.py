"""Voters: the paper's four secondary ones, each a single proportion of the drawing."""

from abc import ABC, abstractmethod
from math import log2, pi

import numpy as np

from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.base import absolute_differences


class _Proportion(ABC):
    """A voter whose descriptor is one number, compared by its difference (paper, Sec. IV-D2)."""

    def length(self, keypoints: int) -> int:
        """Return the number of descriptors, whatever the number of keypoints."""
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


class AspectRatio(_Proportion):
    """``log2(width / height)`` of the box around the strokes.

    The logarithm is ours: twice as wide and twice as high are then equally far from square.
    """

    name = "aspect_ratio"
    unit = "doublings of width over height"

    def measure(self, drawing: Drawing) -> float:
        """Return 0 for a square box, > 0 for a wide one, < 0 for a high one."""
        width, height = drawing.outline.box
        return log2(width / height)


class Solidity(_Proportion):
    """Area inside the outline over the area of its convex hull: 1 for a disc, small for a V."""

    name = "solidity"
    unit = "share of the convex hull's area"

    def measure(self, drawing: Drawing) -> float:
        """Return the share, in (0, 1]."""
        return drawing.outline.area / drawing.outline.hull_area


class Circularity(_Proportion):
    """``4 pi a / p^2`` of the outline's area a and perimeter p: 1 for a disc, 0.79 for a square."""

    name = "circularity"
    unit = "share of the area of a disc with the same perimeter"

    def measure(self, drawing: Drawing) -> float:
        """Return the circularity, in (0, 1]."""
        return 4 * pi * drawing.outline.area / drawing.outline.perimeter**2


class PathComplexity(_Proportion):
    """Length of the outline over the perimeter of its bounding box: high for a zigzag."""

    name = "path_complexity"
    unit = "perimeters of the bounding box"

    def measure(self, drawing: Drawing) -> float:
        """Return the complexity, about 0.8 for a circle, 1 for a square and more for a zigzag."""
        return drawing.outline.perimeter / (2 * sum(drawing.outline.box))
