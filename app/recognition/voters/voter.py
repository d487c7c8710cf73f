"""What every voter gives: a descriptor of a drawing, and how far descriptors lie apart."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import Protocol

import numpy as np

from app.recognition.features.trajectory_image import Drawing
from app.recognition.poses.sequence import FloatArray


class Voter(Protocol):
    """Judges how much a query looks like each reference, from one point of view.

    A voter sees drawings only through its descriptors, so that each drawing is described once.
    It may look at a drawing's image or at its trajectory.
    """

    @property
    def name(self) -> str:
        """The name in results and language files, in snake_case."""
        ...

    @property
    def unit(self) -> str:
        """What a distance of 1 means, for people."""
        ...

    def length(self, keypoints: int) -> int:
        """Return the length D of the descriptor of a drawing with so many salient keypoints."""
        ...

    def describe(self, drawing: Drawing) -> FloatArray:
        """Describe a drawing that has a stroke.

        Returns
        -------
        ``(D,)`` finite numbers.

        """
        ...

    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Measure how far the query lies from each reference.

        Parameters
        ----------
        query
            ``(D,)`` descriptor.
        references
            ``(G, D)``, one descriptor a row.

        Returns
        -------
        ``(G,)`` in `unit`, >= 0, 0 for the same descriptor.

        """
        ...


def euclidean_distances(query: FloatArray, references: FloatArray) -> FloatArray:
    """Measure the Euclidean distance of ``(D,)`` to each row of ``(G, D)``: ``(G,)``.

    The paper's choice (Sec. IV-D1): cosine similarity would ignore magnitudes.
    """
    apart = references - query
    return np.asarray(np.sqrt(np.vecdot(apart, apart)), dtype=np.float64)


def absolute_differences(query: FloatArray, references: FloatArray) -> FloatArray:
    """Measure by how much ``(1,)`` differs from each row of ``(G, 1)``: ``(G,)``."""
    return np.asarray(np.abs(references - query)[:, 0], dtype=np.float64)


DESCRIPTOR_DIGITS = 6
"""Decimals of a descriptor: files stay small, and a saved language decides as before saving."""


def describe(drawing: Drawing, voters: Sequence[Voter]) -> dict[str, FloatArray]:
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
