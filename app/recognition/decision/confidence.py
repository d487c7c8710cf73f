"""Confidence: the probability that the label of a take is right.

Profile ``full`` estimates it from the novelty of the nearest gesture and from how much farther the
second one is. Profile ``paper`` has the share of votes in its place (`majority_vote`).
"""

from __future__ import annotations

import math

from app.recognition.decision.outcome import SCORE_FLOOR

CONFIDENCE_AT_ONE = -2.2
CONFIDENCE_PER_NOVELTY = -2.6
CONFIDENCE_PER_SHARE = -2.9
"""Coefficients of `estimate_confidence`, fitted on thirteen sets, in languages of half the classes.
Without any one of the sets they differ by at most 0.6 (`benchmarks/studies/cutting.md`)."""

SURE = 0.2
"""Least confidence of a take with a label, and largest of one that is asked back."""

TIE_EXPONENT = 9.0
"""Exponent of the probability that the nearest of two gestures is meant: a logistic fit to takes of
six recorded sets, 6 to 15 on each. The probability is 0.84 with a runner-up 1.2 times as far, and
0.97 with one 1.5 times as far."""


def estimate_confidence(novelty: float, nearest: float, second: float) -> float:
    """Estimate the probability that the nearest gesture is the one meant.

    ``1 / (1 + exp(-(b0 + b1 ln n + b2 ln(s / t))))`` for the novelty n and the scores s of the
    nearest and t of the second gesture, 0.02 added to each: novelty separates gestures from
    out-of-vocabulary movements, the ratio separates the two gestures. The coefficients are a
    logistic regression on other people's recordings, half of them out-of-vocabulary; the
    reliability table is in `docs/results.md`. The result is at most ``1 / (1 + (s / t)^9)``: of two
    equally near gestures, each has probability 0.5, however near they are.

    Parameters
    ----------
    novelty
        Novelty of the nearest gesture. NaN where nothing is rejected: then the score is
        used, which is about 1 for another gesture.
    nearest, second
        Scores by `fusion.fuse`. Without a second gesture `second` is infinite and counts as the
        typical distance 1.

    """
    far = math.log((novelty if math.isfinite(novelty) else nearest) + SCORE_FLOOR)
    here = math.log(nearest + SCORE_FLOOR)
    there = math.log((second if math.isfinite(second) else 1.0) + SCORE_FLOOR)
    odds = CONFIDENCE_AT_ONE + CONFIDENCE_PER_NOVELTY * far + CONFIDENCE_PER_SHARE * (here - there)
    # Both exponents are at most 700, just below the overflow of a double.
    meant = 1.0 / (1.0 + math.exp(min(-odds, 700.0)))
    this_one = 1.0 / (1.0 + math.exp(min(TIE_EXPONENT * (here - there), 700.0)))
    return min(meant, this_one)


def bound_confidence(confidence: float, answers: int) -> float:
    """Return a confidence of at least `SURE` with one answer, and of at most `SURE` with two."""
    if answers == 1:
        return max(SURE, confidence)
    return min(SURE, confidence) if answers == 2 else confidence
