"""Base class of shape voters, which compare trajectory images."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from itertools import accumulate

import numpy as np

from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.voter import Voter

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
