"""Error-rate bound: how many takes show that a diver's error rate is below a limit."""

from __future__ import annotations

from functools import lru_cache
from math import exp, lgamma, log, log1p

LIMIT = 0.05
"""Error rate that a diver's takes must be below: one misunderstood gesture in twenty."""

CONFIDENCE = 0.95
"""Confidence of the bound, one-sided as in the rule of three (Hanley and Lippman-Hand 1983)."""

STEPS = 50
"""Number of bisections of [0, 1]: more precise than any number that is shown."""


@lru_cache(1024)
def bound_error_rate(errors: int, takes: int, confidence: float = CONFIDENCE) -> float:
    """Return the upper confidence bound of an error rate (Clopper and Pearson 1934).

    Without takes it is 1; without errors it is about 3 / `takes`, the rule of three.
    """
    if errors >= takes:
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(STEPS):
        middle = (low + high) / 2
        if _at_most(errors, takes, middle) > 1 - confidence:
            low = middle
        else:
            high = middle
    return high


@lru_cache(1024)
def count_takes_needed(errors: int, limit: float = LIMIT, confidence: float = CONFIDENCE) -> int:
    """Return the least number of takes that, with these errors, show a rate below `limit`."""
    low, high = errors, errors + 1
    while bound_error_rate(errors, high, confidence) >= limit:
        low, high = high, 2 * high
    while high - low > 1:
        middle = (low + high) // 2
        if bound_error_rate(errors, middle, confidence) < limit:
            high = middle
        else:
            low = middle
    return high


def _at_most(errors: int, takes: int, rate: float) -> float:
    """Return the probability of at most `errors` errors; `rate` lies between 0 and 1."""
    whole = lgamma(takes + 1)
    return sum(
        exp(
            whole
            - lgamma(count + 1)
            - lgamma(takes - count + 1)
            + count * log(rate)
            + (takes - count) * log1p(-rate)
        )
        for count in range(errors + 1)
    )
