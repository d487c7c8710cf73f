"""Methods that are trained on variants of the one demonstration, as Cabrera and Wachs (2017) do."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from app.recognition import PoseSequence
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import draw_variants
from benchmarks.methods.base import Method
from benchmarks.methods.steps import features

VARIANTS = 30
"""Variants of each gesture that are trained on, beside the demonstration itself: few enough that
all methods are trained on hundreds of languages in one run."""


class TrainedOnVariants(Method):
    """Draws variants when a gesture is added, and is trained anew on all of them."""

    def __init__(self) -> None:
        self._labels: list[str] = []
        self._sequences: list[FloatArray] = []

    def add(self, label: str, demonstration: PoseSequence) -> None:
        """Draw variants as other people's takes would differ, and describe them."""
        shown = Trajectory.from_poses(demonstration).fill_gaps(np.inf)
        drawn = draw_variants(shown, VARIANTS, seed=len(self._labels), person="another")
        self._labels.append(label)
        self._sequences.append(np.array([features(each) for each in (shown, *drawn)]))

    def prepare(self) -> None:
        """Train on the variants of all gestures."""
        self.train(self._sequences)

    def answer(self, query: PoseSequence) -> str:
        """Return the label of the likeliest gesture."""
        return self._labels[self.likeliest(features(Trajectory.from_poses(query)))]

    @abstractmethod
    def train(self, sequences: list[FloatArray]) -> None:
        """Fit the model to sequences ``(VARIANTS + 1, STEPS, D)`` of each of the G gestures."""

    @abstractmethod
    def likeliest(self, sequence: FloatArray) -> int:
        """Return the index of the gesture that a sequence ``(STEPS, D)`` most likely is."""
