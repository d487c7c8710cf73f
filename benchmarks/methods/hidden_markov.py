"""Hidden Markov models, one for each gesture."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
from hmmlearn.hmm import GaussianHMM

from app.recognition.poses.sequence import FloatArray
from benchmarks.methods.steps import STEPS
from benchmarks.methods.trained import TrainedOnVariants

STATES = 8
"""Number of states, each of four of the 32 steps."""

LEAST_VARIANCE = 1e-3
"""Least variance of a coordinate in a state, in squared sizes; takes of a gesture differ by
more."""

ROUNDS = 10
"""Iterations of expectation maximisation."""


class HiddenMarkov(TrainedOnVariants):
    """Left-to-right models with one Gaussian a state; the likeliest model answers."""

    def train(self, sequences: list[FloatArray]) -> None:
        """Fit the gestures' models, each to its own variants."""
        # The library logs every round in which the likelihood no longer grows.
        logging.getLogger("hmmlearn").setLevel(logging.ERROR)
        self._models: list[Any] = [_fit(each) for each in sequences]

    def likeliest(self, sequence: FloatArray) -> int:
        """Compare the likelihoods of the whole sequence."""
        return int(np.argmax([model.score(sequence) for model in self._models]))


def _fit(sequences: FloatArray) -> Any:
    model = GaussianHMM(
        STATES,
        covariance_type="diag",
        min_covar=LEAST_VARIANCE,
        n_iter=ROUNDS,
        init_params="",
        params="tmc",
        random_state=0,
    )
    parts = np.array_split(sequences, STATES, axis=1)
    size = sequences.shape[2]
    model.startprob_ = np.eye(STATES)[0]
    stay = 1 - STATES / STEPS
    model.transmat_ = np.diag([stay] * (STATES - 1) + [1.0]) + np.diag([1 - stay] * (STATES - 1), 1)
    model.means_ = np.array([part.reshape(-1, size).mean(axis=0) for part in parts])
    model.covars_ = np.array(
        [part.reshape(-1, size).var(axis=0) + LEAST_VARIANCE for part in parts]
    )
    model.fit(np.concatenate(list(sequences)), [STEPS] * len(sequences))
    return model
