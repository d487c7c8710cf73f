"""The base of voters that compare drawings: trajectory images of salient landmarks."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from itertools import accumulate

import numpy as np

from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray
from app.recognition.voters.voter import Voter

DESCRIPTOR_DIGITS = 6
"""Decimals of a descriptor: files stay small, and a saved language decides as before saving."""


class ShapeVoter(Voter):
    """A voter that compares a query's drawing with each gesture's.

    It sees drawings only through its descriptors, so that each drawing is described once.
    """

    @abstractmethod
    def length(self, keypoints: int) -> int:
        """Return the length D of the descriptor of a drawing with so many salient landmarks."""

    @abstractmethod
    def describe(self, drawing: Drawing) -> FloatArray:
        """Describe a drawing that has a stroke by ``(D,)`` finite numbers."""


def describe_drawing(drawing: Drawing, voters: Sequence[ShapeVoter]) -> dict[str, FloatArray]:
    """Describe a drawing once for each voter.

    Returns
    -------
    Per voter's name its descriptor, rounded; empty for an empty drawing.

    """
    if drawing.empty:
        return {}
    described = [voter.describe(drawing) for voter in voters]
    # Adding 0 turns -0.0 into 0.0, which files could not tell apart.
    rounded = np.round(np.concatenate([*described, []]), DESCRIPTOR_DIGITS) + 0.0
    ends = accumulate(len(each) for each in described)
    return {
        voter.name: rounded[end - len(each) : end]
        for voter, each, end in zip(voters, described, ends, strict=True)
    }
