"""Two-sample statistics: distribution difference, coverage, and a classifier."""

from __future__ import annotations

import numpy as np

from app.recognition.poses.sequence import FloatArray


def kolmogorov_smirnov(one: FloatArray, other: FloatArray) -> float:
    """Return the largest difference between two samples' cumulative distributions."""
    every = np.sort(np.concatenate([one, other]))
    below = [
        np.searchsorted(np.sort(each), every, side="right") / len(each) for each in (one, other)
    ]
    return float(np.abs(below[0] - below[1]).max())


def coverage(real: FloatArray, varied: FloatArray, share: float = 0.95) -> float:
    """Return the share of real takes ``(N,)`` up to that quantile of their variants ``(N, M)``."""
    return float((real <= np.quantile(varied, share, axis=1)).mean())


def separability(real: FloatArray, varied: FloatArray, folds: int = 5) -> float:
    """Return the cross-validated separability of variants and real takes by logistic regression.

    The area under the curve: 0.5 is not at all, 1 always. Features are standardised, and their
    squares stand beside them, so that a wrong spread is seen as well as a wrong mean.
    """
    features = np.concatenate([real, varied])
    label = np.repeat([0.0, 1.0], [len(real), len(varied)])
    fold = np.concatenate([np.arange(len(real)) % folds, np.arange(len(varied)) % folds])
    scores = np.empty(len(label))
    for each in range(folds):
        train = fold != each
        mean, spread = features[train].mean(axis=0), features[train].std(axis=0) + 1e-9
        scaled = np.clip((features - mean) / spread, -4, 4)
        design = np.column_stack([np.ones(len(scaled)), scaled, scaled**2])
        scores[~train] = design[~train] @ _logistic(design[train], label[train])
    return _area(scores, label)


def _logistic(design: FloatArray, label: FloatArray, ridge: float = 1.0) -> FloatArray:
    """Fit by Newton's method, with a ridge."""
    weights = np.zeros(design.shape[1])
    for _ in range(20):
        chance = 1 / (1 + np.exp(-np.clip(design @ weights, -30, 30)))
        slope = design.T @ (label - chance) - ridge * weights
        curve = (design * (chance * (1 - chance))[:, None]).T @ design
        weights += np.linalg.solve(curve + ridge * np.eye(len(weights)), slope)
    return weights


def _area(scores: FloatArray, label: FloatArray) -> float:
    ranks = np.empty(len(scores))
    ranks[np.argsort(scores)] = np.arange(1, len(scores) + 1)
    ones = int(label.sum())
    below = ranks[label == 1].sum() - ones * (ones + 1) / 2
    return float(below / (ones * (len(label) - ones)))
