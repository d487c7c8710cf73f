"""Error-rate bound: how many takes show that a diver's error rate is below a limit."""

from __future__ import annotations

from bisect import bisect_left
from functools import lru_cache
from math import exp, lgamma, log, log1p

LIMIT = 0.05
"""Error rate that a diver's takes must be below: one misunderstood gesture in twenty."""

CONFIDENCE = 0.95
"""Confidence of the bound, one-sided as in the rule of three (Hanley and Lippman-Hand 1983)."""

MOST_TAKES = 1_000_000
"""Most takes counted, far more than anybody shows."""

STEPS = 50
"""Number of bisections of [0, 1]: more precise than any number that is shown."""


@lru_cache(1024)
def bound_error_rate(errors: int, takes: int) -> float:
    """Return the upper confidence bound of an error rate (Clopper and Pearson 1934).

    Without takes it is 1; without errors it is about 3 / `takes`, the rule of three.
    """
    if errors >= takes:
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(STEPS):
        middle = (low + high) / 2
        if _at_most(errors, takes, middle) > 1 - CONFIDENCE:
            low = middle
        else:
            high = middle
    return high


@lru_cache(1024)
def count_takes_needed(errors: int) -> int:
    """Return the least number of takes that, with these errors, show a rate below `LIMIT`.

    At most `MOST_TAKES`.
    """

    def suffice(takes: int) -> bool:
        return bound_error_rate(errors, takes) < LIMIT

    return bisect_left(range(MOST_TAKES), True, lo=errors, key=suffice)


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
