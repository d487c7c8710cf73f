"""A support vector machine on whole movements."""

from __future__ import annotations

from typing import Any

import numpy as np
from sklearn.svm import SVC

from app.recognition.poses.sequence import FloatArray
from benchmarks.methods.trained import TrainedOnVariants

PENALTY = 10.0
"""Penalty of margin violations: variants of two demonstrations hardly overlap."""


class SupportVectors(TrainedOnVariants):
    """One vector per movement, with a Gaussian kernel of the customary width.

    Coordinates keep their common unit: if each were standardised, resting ones would count as much
    as moving ones.
    """

    def train(self, sequences: list[FloatArray]) -> None:
        """Fit one machine for each pair of gestures."""
        rows = np.concatenate(sequences)
        owners = np.repeat(np.arange(len(sequences)), [len(each) for each in sequences])
        self._machine: Any = SVC(C=PENALTY)
        self._machine.fit(rows.reshape(len(rows), -1), owners)

    def likeliest(self, sequence: FloatArray) -> int:
        """Return the label with most votes of the pairwise machines."""
        return int(self._machine.predict(sequence.reshape(1, -1))[0])
