"""Rates: how often something happened among what was tried, with a 95 % interval."""

from __future__ import annotations

import math
from dataclasses import dataclass, is_dataclass
from typing import Any, Final

STANDARD_ERRORS: Final = 1.96
"""Standard errors to either side of a 95 % interval of a normal distribution."""

DIGITS: Final = 4
"""Decimals in JSON: a hundredth of a per cent, far below the accuracy of any rate here."""


@dataclass(frozen=True)
class Rate:
    """A counted share.

    Attributes
    ----------
    happened, n
        How often it happened, of n > 0.

    """

    happened: int
    n: int

    @property
    def rate(self) -> float:
        """The share, in [0, 1]."""
        return self.happened / self.n

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's 95 % interval (Wilson 1927)."""
        square = STANDARD_ERRORS**2 / self.n
        middle = (self.rate + square / 2) / (1 + square)
        spread = math.sqrt(self.rate * (1 - self.rate) * square + square * square / 4)
        half = spread / (1 + square)
        # Rounding may move an end past the rate.
        return max(0.0, min(self.rate, middle - half)), min(1.0, max(self.rate, middle + half))

    def __str__(self) -> str:
        low, high = self.interval
        return f"{self.rate:.0%} ({low:.0%}-{high:.0%}, n {self.n})"


def to_plain(value: Any) -> Any:
    """Return a part of a report in plain JSON types, numbers rounded to `DIGITS`."""
    if isinstance(value, Rate):
        low, high = value.interval
        return to_plain({"rate": value.rate, "low": low, "high": high, "n": value.n})
    if is_dataclass(value):
        return to_plain(vars(value))
    if isinstance(value, dict):
        return {name: to_plain(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [to_plain(each) for each in value]
    return round(value, DIGITS) if isinstance(value, float) else value
