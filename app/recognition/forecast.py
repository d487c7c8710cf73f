"""Forecasts: how often something will happen, estimated from few rehearsals, with its interval.

Counting is too coarse here: of a dozen rehearsed takes none may be misread although one in fifty
will be. What is known of each is more than whether it was misread: by how much it was not. Real
takes differ from rehearsed ones by more than variants differ; a rehearsed take stands for all
real ones around it, and some of those lie beyond the margin (a kernel estimate, Parzen 1962).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.recognition.poses import FloatArray

STANDARD_ERRORS = 1.96
"""Standard errors to either side that hold 95 % of a normal distribution."""

LEAST_VARIANCE = 1e-12
"""Least variance of probabilities: below it they are all the same but for rounding."""

LARGEST_EXPONENT = 700.0
"""Below the logarithm of the largest number; the probability is 0 long before."""

DIGITS = 4
"""Decimals in JSON: a hundredth of a per cent, far below what a dozen takes can tell."""


@dataclass(frozen=True)
class Forecast:
    """An estimated probability.

    Attributes
    ----------
    rate
        In [0, 1].
    low, high
        Its interval, 95 %, as far as the number of rehearsals goes. That people may differ in
        other ways than was foreseen is not in it.

    """

    rate: float
    low: float
    high: float

    @classmethod
    def of_margins(cls, margins: FloatArray, unforeseen: float) -> Forecast:
        """Estimate the probability of a margin below 0.

        Parameters
        ----------
        margins
            ``(N,)``, N >= 2, finite: of the rehearsed takes.
        unforeseen
            Scale > 0 of the logistic distribution by which real margins differ from rehearsed
            ones; its tails are heavier than a normal distribution's, as are people's.

        Returns
        -------
        The mean of each take's probability ``1 / (1 + exp(margin / unforeseen))``, with Wilson's
        interval for as many takes counted as would spread that mean alike.

        """
        chances = 1 / (1 + np.exp(np.minimum(margins / unforeseen, LARGEST_EXPONENT)))
        mean = float(chances.mean())
        variance = max(float(chances.var(ddof=1)), LEAST_VARIANCE) / len(chances)
        return cls._wilson(mean, max(mean * (1 - mean) / variance, len(chances)))

    @classmethod
    def of_count(cls, happened: int, count: int) -> Forecast:
        """Estimate from a count out of `count` > 0, with Wilson's interval (Wilson 1927)."""
        return cls._wilson(happened / count, count)

    @classmethod
    def _wilson(cls, share: float, count: float) -> Forecast:
        square = STANDARD_ERRORS**2 / count
        middle = (share + square / 2) / (1 + square)
        half = math.sqrt(share * (1 - share) * square + square * square / 4) / (1 + square)
        # Rounding may push an end past the share it belongs to.
        return cls(share, max(0.0, min(share, middle - half)), min(1.0, max(share, middle + half)))

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types, rounded."""
        return {name: round(value, DIGITS) for name, value in vars(self).items()}
