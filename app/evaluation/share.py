"""Share of correct answers, with its confidence interval."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from app.recognition.health.finding import Rate


@dataclass(frozen=True)
class Share:
    """Share of correct answers.

    Attributes
    ----------
    correct, asked
        Numbers of correct answers and of queries; without queries there is no share.

    """

    correct: int
    asked: int

    @property
    def value(self) -> float | None:
        """The share in [0, 1], or None without queries."""
        return self.correct / self.asked if self.asked else None

    def interval(self) -> tuple[float, float] | None:
        """Return Wilson's 95 % interval (Wilson 1927), or None without queries."""
        return Rate(self.correct, self.asked).interval if self.asked else None

    def __add__(self, other: Share) -> Share:
        return Share(self.correct + other.correct, self.asked + other.asked)

    def __str__(self) -> str:
        interval = self.interval()
        if self.value is None or interval is None:
            return "-"
        low, high = interval
        return f"{self.value:.1%} ({low:.0%}-{high:.0%})"

    def to_dict(self) -> dict[str, Any]:
        """Convert to plain JSON types."""
        interval = self.interval()
        return {
            "correct": self.correct,
            "asked": self.asked,
            "share": self.value,
            "interval": None if interval is None else list(interval),
        }
