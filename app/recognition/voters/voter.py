"""Base classes of voters: a distance between descriptors, and the constants that weigh it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np

from app.recognition.poses.sequence import FloatArray


class Voter(ABC):
    """One voter: a distance between a query and each reference.

    Attributes
    ----------
    name
        In results and language files, in snake_case.
    unit
        What a distance of 1 means, in words.

    """

    name: ClassVar[str]
    unit: ClassVar[str]

    @abstractmethod
    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Compute the distance of the query to each reference.

        Parameters
        ----------
        query
            The descriptor of the query.
        references
            One descriptor of the same shape for each reference, stacked along the first axis.

        Returns
        -------
        ``(M,)`` in `unit`, >= 0, 0 for the same descriptor; infinite where nothing is comparable.

        """


class WeightedVoter(Voter):
    """Base of the voters of profile ``full``, with constants that give their weight (`fusion`).

    The constants were measured on drawn digits, letters and commands, two-handed figures, aircraft
    marshalling and whole bodies, by other people: the geometric mean over the sets
    (``benchmarks/studies/people.md``).

    Attributes
    ----------
    prior
        Importance before it is adapted to a language; `velocity` has 1.
    within
        Within-class distance: mean between two people's takes of one gesture.
    between
        Between-class distance: median between two gestures; stands in where a language has one.

    """

    prior: ClassVar[float]
    within: ClassVar[float]
    between: ClassVar[float]

    def prior_for(self, *, arms: bool) -> float:
        """Return the prior in a language in which the elbows are seen, or hands alone."""
        return self.prior


def euclidean_distances(query: FloatArray, references: FloatArray) -> FloatArray:
    """Return the Euclidean distances of ``(D,)`` to each row of ``(G, D)``: ``(G,)``.

    As in the paper (Sec. IV-D1), because cosine similarity ignores magnitudes.
    """
    apart = references - query
    return np.asarray(np.sqrt(np.vecdot(apart, apart)), dtype=np.float64)


def absolute_differences(query: FloatArray, references: FloatArray) -> FloatArray:
    """Return the absolute differences of ``(1,)`` to each row of ``(G, 1)``: ``(G,)``."""
    return np.asarray(np.abs(references - query)[:, 0], dtype=np.float64)
