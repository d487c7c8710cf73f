"""Forecasts: how often something will happen, estimated from few rehearsals, with its interval.

Counting is too coarse here: of a dozen rehearsed takes none may be misread although one in fifty
will be. What is known of each is more than whether it was misread: by how much it was not. Their
mean tells how far real takes lie from being misread, and how real takes scatter about it is known
from people. How the rehearsed takes scatter is not asked: variants have a heavier tail than people,
and asked one by one they warned of five confusions for each that came true (`docs/health.md`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from app.recognition.poses.sequence import FloatArray
from app.recognition.simulation.variant_bias import VariantBias

STANDARD_ERRORS = 1.96
"""Standard errors to either side that hold 95 % of a normal distribution."""

LARGEST_EXPONENT = 700.0
"""Below the logarithm of the largest number; the probability is 0 long before."""

DIGITS = 4
"""Decimals in JSON: a hundredth of a per cent, far below what a dozen takes can tell."""


@dataclass(frozen=True)
class RateEstimate:
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
    def of_margins(
        cls, margins: FloatArray, unforeseen: VariantBias, astray: float = 1.0
    ) -> RateEstimate:
        """Estimate the probability of a margin below 0.

        Parameters
        ----------
        margins
            ``(N,)``, N >= 2, finite: of the rehearsed takes.
        unforeseen
            How real takes stray from rehearsed ones: the share e of takes that are not what was
            shown, and the scale h by which the margins of the others scatter about the mean of the
            rehearsed ones. Their distribution is logistic, with heavier tails than the normal one.
        astray
            In [0, 1]: how probable it is for a take that is not what was shown.

        Returns
        -------
        ``e astray + (1 - e) / (1 + exp(mean / h))``; its interval is that of the mean.

        """
        mean = float(margins.mean())
        error = STANDARD_ERRORS * float(margins.std(ddof=1)) / math.sqrt(len(margins))
        rate, low, high = (
            unforeseen.otherwise * astray
            + (1 - unforeseen.otherwise)
            / (1 + math.exp(min(end / unforeseen.scatter, LARGEST_EXPONENT)))
            for end in (mean, mean + error, mean - error)
        )
        return cls(rate, low, high)

    @classmethod
    def of_count(cls, happened: int, count: int) -> RateEstimate:
        """Estimate from a count out of `count` > 0, with Wilson's interval (Wilson 1927)."""
        share = happened / count
        square = STANDARD_ERRORS**2 / count
        middle = (share + square / 2) / (1 + square)
        half = math.sqrt(share * (1 - share) * square + square * square / 4) / (1 + square)
        # Rounding may push an end past the share it belongs to.
        return cls(share, max(0.0, min(share, middle - half)), min(1.0, max(share, middle + half)))

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types, rounded."""
        return {name: round(value, DIGITS) for name, value in vars(self).items()}
