"""Methods that are trained on variants of the one demonstration, as Cabrera and Wachs (2017) do."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from app.recognition import PoseSequence
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.variation import draw_variants
from benchmarks.methods.base import Demonstration, Method, Prediction
from benchmarks.methods.steps import features

VARIANTS = 30
"""Variants of each gesture that are trained on, beside the demonstration itself: few enough that
all methods are trained on hundreds of languages in one run."""


class TrainedOnVariants(Method):
    """Draws variants as other people's takes would differ, and is trained on all of them."""

    def fit(self, demonstrations: Sequence[Demonstration]) -> None:
        """Train on the demonstrations and their variants."""
        sequences: dict[str, list[FloatArray]] = {}
        for number, each in enumerate(demonstrations):
            shown = Trajectory.from_poses(each.poses).fill_gaps(np.inf)
            drawn = draw_variants(shown, VARIANTS, seed=number, person="another")
            sequences.setdefault(each.label, []).extend(features(one) for one in (shown, *drawn))
        self._labels = [*sequences]
        self.train([np.array(each) for each in sequences.values()])

    def predict(self, take: PoseSequence) -> Prediction:
        """Answer the likeliest gesture."""
        return Prediction(self._labels[self.likeliest(features(Trajectory.from_poses(take)))])

    @abstractmethod
    def train(self, sequences: list[FloatArray]) -> None:
        """Fit the model to the sequences ``(N, STEPS, D)`` of each of the G gestures."""

    @abstractmethod
    def likeliest(self, sequence: FloatArray) -> int:
        """Return the index of the gesture that a sequence ``(STEPS, D)`` most likely is."""
