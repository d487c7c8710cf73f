"""Shape voters: compare trajectory images (paper, Sec. IV-D), most of them by one proportion."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from itertools import accumulate
from math import log2, pi

import numpy as np

from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.voter import Voter, absolute_differences

DESCRIPTOR_DIGITS = 6
"""Decimals of a descriptor: files stay small, and a saved language gives the same results."""


class ShapeVoter(Voter):
    """Base of voters that compare a query's drawing with each gesture's.

    They compare descriptors only, so that each drawing is described once.
    """

    @abstractmethod
    def length(self, keypoints: int) -> int:
        """Return D, the length of the descriptor for a number of salient landmarks."""

    @abstractmethod
    def describe(self, drawing: Drawing) -> FloatArray:
        """Return the descriptor of a drawing that has a stroke: ``(D,)`` finite numbers."""


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


class AspectRatio(ProportionVoter):
    """Difference of ``log2(width / height)`` of the box around the strokes.

    The paper has no logarithm; with it, twice as wide and twice as high are equally far from
    square.
    """

    name = "aspect_ratio"
    unit = "doublings of width over height"

    def measure(self, drawing: Drawing) -> float:
        """Return 0 for a square box, > 0 for a wide one, < 0 for a high one."""
        width, height = drawing.contour.box
        return log2(width / height)


class Solidity(ProportionVoter):
    """Area of the contour over the area of its convex hull: 1 for a disc, small for a V."""

    name = "solidity"
    unit = "share of the convex hull's area"

    def measure(self, drawing: Drawing) -> float:
        """Return the share, in (0, 1]."""
        return drawing.contour.area / drawing.contour.hull_area


class Circularity(ProportionVoter):
    """``4 pi a / p^2`` of the contour's area a and perimeter p: 1 for a disc, 0.79 for a square."""

    name = "circularity"
    unit = "share of the area of a disc with the same perimeter"

    def measure(self, drawing: Drawing) -> float:
        """Return the circularity, in (0, 1]."""
        return 4 * pi * drawing.contour.area / drawing.contour.perimeter**2


class PathComplexity(ProportionVoter):
    """Length of the contour over the perimeter of its bounding box: high for a zigzag."""

    name = "path_complexity"
    unit = "perimeters of the bounding box"

    def measure(self, drawing: Drawing) -> float:
        """Return the complexity, about 0.8 for a circle, 1 for a square and more for a zigzag."""
        return drawing.contour.perimeter / (2 * sum(drawing.contour.box))


def describe_drawing(drawing: Drawing, voters: Sequence[ShapeVoter]) -> dict[str, FloatArray]:
    """Compute the descriptors of a drawing for several voters.

    Returns
    -------
    The rounded descriptors by the voters' names; empty for an empty drawing.

    """
    if drawing.empty:
        return {}
    described = [voter.describe(drawing) for voter in voters]
    # Adding 0 turns -0.0 into 0.0, which files do not distinguish.
    rounded = np.round(np.concatenate([*described, []]), DESCRIPTOR_DIGITS) + 0.0
    ends = accumulate(len(each) for each in described)
    return {
        voter.name: rounded[end - len(each) : end]
        for voter, each, end in zip(voters, described, ends, strict=True)
    }
