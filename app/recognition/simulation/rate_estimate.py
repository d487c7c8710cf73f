"""Rate estimates: the probability of an error, from few simulated takes, with an interval.

Counting errors is too coarse: of a dozen takes none may be misread at a rate of one in fifty. The
estimate uses the mean of the takes' margins and the scatter of people's takes. The simulated takes'
own scatter is not used: variants have a heavier tail than people and predicted five confusions for
each that was observed (`benchmarks/studies/predictions.md`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from app.recognition.poses.sequence import FloatArray
from app.recognition.simulation.variant_bias import VariantBias

STANDARD_ERRORS = 1.96
"""Standard errors to either side of a 95 % interval of a normal distribution."""

LARGEST_EXPONENT = 700.0
"""Just below the logarithm of the largest double; the probability is 0 long before."""

DIGITS = 4
"""Decimals in JSON: a hundredth of a per cent, far below the estimates' accuracy."""


@dataclass(frozen=True)
class RateEstimate:
    """An estimated probability.

    Attributes
    ----------
    rate
        In [0, 1].
    low, high
        Its 95 % interval for the number of simulated takes; errors of the simulation itself are
        not included.

    """

    rate: float
    low: float
    high: float

    @classmethod
    def of_margins(
        cls, margins: FloatArray, bias: VariantBias, astray: float = 1.0
    ) -> RateEstimate:
        """Estimate the probability of a margin below 0.

        Parameters
        ----------
        margins
            ``(N,)``, N >= 2, finite: of the simulated takes.
        bias
            How real takes differ from simulated ones: the share e of takes that show something
            else, and the scale h of the logistic distribution (heavier tails than the normal one)
            of the others' margins about the mean of the simulated ones.
        astray
            In [0, 1]: the probability for a take that shows something else.

        Returns
        -------
        ``e astray + (1 - e) / (1 + exp(mean / h))``; its interval is that of the mean.

        """
        mean = float(margins.mean())
        error = STANDARD_ERRORS * float(margins.std(ddof=1)) / math.sqrt(len(margins))
        rate, low, high = (
            bias.otherwise * astray
            + (1 - bias.otherwise) / (1 + math.exp(min(end / bias.scatter, LARGEST_EXPONENT)))
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
        # Rounding may move an end past the rate.
        return cls(share, max(0.0, min(share, middle - half)), min(1.0, max(share, middle + half)))

    @property
    def words(self) -> str:
        """The estimate in words: "about 1 of 5 takes (9 to 35 %)"."""
        few = f"1 of {1 / self.rate:.0f}" if 0 < self.rate < 0.4 else f"{10 * self.rate:.0f} of 10"
        return f"about {few} takes ({100 * self.low:.0f} to {100 * self.high:.0f} %)"

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types, rounded."""
        return {name: round(value, DIGITS) for name, value in vars(self).items()}
