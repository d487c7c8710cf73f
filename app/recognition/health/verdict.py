"""Verdict on a language: the errors of its check, and what a test has shown of its gestures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any


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
