"""Verdict on a language: the errors of its check, and what a test has shown of its gestures.

Rates: how often something happened among what was tried, with a 95 % interval.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
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


@dataclass(frozen=True)
class TestedGesture:
    """What the test of a language has shown of one gesture.

    Attributes
    ----------
    label
        Its label.
    right, asked
        Number of its takes that are read right, and of those that were read by demonstrations other
        than themselves.

    """

    __test__ = False

    label: str
    right: int
    asked: int

    @property
    def fails(self) -> bool:
        """Whether less than half of its takes are read right."""
        return 2 * self.right < self.asked


@dataclass(frozen=True)
class Verdict:
    """Verdict on a language, one for the page, the export and the command line.

    Attributes
    ----------
    errors
        Number of errors that the check has found.
    failing
        Gestures of which less than half of the takes are read right.
    untested
        Labels of the gestures of which no take was read.
    gestures
        Number of gestures of the language.

    """

    errors: int
    failing: tuple[TestedGesture, ...] = ()
    untested: tuple[str, ...] = ()
    gestures: int = 0

    @classmethod
    def of(
        cls, errors: int, labels: Sequence[str], tested: Sequence[TestedGesture] = ()
    ) -> Verdict:
        """Return the verdict on a language with these labels; `tested` may name others."""
        known = [each for each in tested if each.asked and each.label in labels]
        seen = {each.label for each in known}
        return cls(
            errors,
            tuple(each for each in known if each.fails),
            tuple(label for label in labels if label not in seen),
            len(labels),
        )

    @property
    def is_ready(self) -> bool:
        """Whether nothing is wrong, and every gesture was tested."""
        return not (self.errors or self.failing or self.untested)

    @property
    def words(self) -> str:
        """The verdict as a clause: "no errors, 3 gestures untested"."""
        return ", ".join(self._parts())

    def _parts(self) -> Iterator[str]:
        if self.errors or not self.failing:
            yield {0: "no errors", 1: "1 error"}.get(self.errors, f"{self.errors} errors")
        yield from (f"{each.label} {each.right} of {each.asked}" for each in self.failing)
        if len(self.untested) == 1:
            yield f"{self.untested[0]} untested"
        elif self.untested:
            all_of_them = len(self.untested) == self.gestures
            yield "no gesture tested" if all_of_them else f"{len(self.untested)} gestures untested"

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON types."""
        return {
            "ready": self.is_ready,
            "words": self.words,
            "errors": self.errors,
            "failing": [vars(each) for each in self.failing],
            "untested": list(self.untested),
        }
