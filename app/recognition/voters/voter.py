"""The base of all voters: descriptors, their distances, and what is known of both."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from app.recognition.poses.sequence import FloatArray

CueGroup = Literal["figure", "posture", "wrist", "length"]
"""What voters of one group look at; see `app.recognition.decision.rejection`."""


@dataclass(frozen=True)
class Cue:
    """How a voter's distance counts towards the rejection of a query.

    Attributes
    ----------
    group
        The cue group it is averaged in: voters of a group make up for each other's noise.
    weight
        Its weight in the mean of its group.
    reach
        The threshold of a gesture, in typical distances of the demonstrator's own further takes.
    squared
        Whether distances are squares, which grow faster from one person to another.
    varies_by_gesture
        Whether the typical distance is measured on the gesture; else it is `Voter.within`.

    """

    group: CueGroup
    weight: float
    reach: float
    squared: bool = True
    varies_by_gesture: bool = True


class Voter(ABC):
    """One voter: a distance between a query and each reference, with its statistics.

    The statistics are measured on air-drawn digits, letters and commands, two-handed figures and
    aircraft marshalling by other people: the geometric mean over the sets
    (``benchmarks/studies``).

    Attributes
    ----------
    name
        In results and language files, in snake_case.
    unit
        What a distance of 1 means, for people.
    prior
        Weight before any language is known; `path` has 1.
    within
        Within-class distance: mean between two people's takes of one gesture.
    between
        Between-class distance: median between two gestures; stands in where a language has one.
    cue
        How its distance counts towards rejection; None: it does not.

    """

    name: ClassVar[str]
    unit: ClassVar[str]
    prior: ClassVar[float]
    within: ClassVar[float]
    between: ClassVar[float]
    cue: ClassVar[Cue | None] = None

    def prior_for(self, landmarks: int) -> float:
        """Return the prior in a language that follows so many landmarks."""
        return self.prior

    @abstractmethod
    def distances(self, query: FloatArray, references: FloatArray) -> FloatArray:
        """Measure how far the query lies from each reference.

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


def euclidean_distances(query: FloatArray, references: FloatArray) -> FloatArray:
    """Measure the Euclidean distance of ``(D,)`` to each row of ``(G, D)``: ``(G,)``.

    The paper's choice (Sec. IV-D1): cosine similarity would ignore magnitudes.
    """
    apart = references - query
    return np.asarray(np.sqrt(np.vecdot(apart, apart)), dtype=np.float64)


def absolute_differences(query: FloatArray, references: FloatArray) -> FloatArray:
    """Measure by how much ``(1,)`` differs from each row of ``(G, 1)``: ``(G,)``."""
    return np.asarray(np.abs(references - query)[:, 0], dtype=np.float64)
