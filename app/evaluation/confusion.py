"""Confusion matrix: counts of gestures shown against labels recognised."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from app.evaluation.proportion import Share

Answer = str | tuple[str, str] | None
"""The label recognised, the pair that was asked back, or None when rejected."""

NONE = "-"
"""Label of takes that show none of the gestures: a refusal of them is right."""

REFUSED = "(none)"
"""Heading of the column for queries without a label. A gesture with the same label would only be
printed ambiguously, not counted so."""


@dataclass(frozen=True, eq=False)
class ConfusionMatrix:
    """Counts of gestures shown and labels recognised.

    Attributes
    ----------
    labels
        L labels in the order of the rows.
    counts
        ``(L, L + 1)``: row shown, column recognised; the last column counts queries without a
        label, because they lie between two gestures, were rejected or could not be compared.
    pairs
        ``(L, 2)``: of these the pairs that were asked back, with and without the gesture shown.

    """

    labels: tuple[str, ...]
    counts: npt.NDArray[np.int64]
    pairs: npt.NDArray[np.int64]

    @classmethod
    def of(
        cls, labels: Sequence[str], shown: Sequence[str], read: Sequence[Answer]
    ) -> ConfusionMatrix:
        """Count pairs of labels shown and recognised.

        Parameters
        ----------
        labels
            All labels that occur in `shown` or in `read`; a refusal of `NONE` is read as `NONE`.
        shown, read
            Label shown and answer of each query.

        """
        position = {label: index for index, label in enumerate(labels)}
        counts = np.zeros((len(labels), len(labels) + 1), dtype=np.int64)
        pairs = np.zeros((len(labels), 2), dtype=np.int64)
        for truth, answer in zip(shown, read, strict=True):
            found = NONE if truth == NONE and answer is None else answer
            column = position[found] if isinstance(found, str) else len(labels)
            counts[position[truth], column] += 1
            if isinstance(answer, tuple):
                pairs[position[truth], int(truth not in answer)] += 1
        return cls(tuple(labels), counts, pairs)

    @property
    def correct(self) -> Share:
        """Queries recognised as the gesture shown."""
        return Share(int(np.trace(self.counts)), int(self.counts.sum()))

    @property
    def refused(self) -> Share:
        """Queries with neither a label nor a pair."""
        without = int(self.counts[:, -1].sum()) - self.asked_back.asked
        return Share(without, int(self.counts.sum()))

    @property
    def asked_back(self) -> Share:
        """Queries answered with a pair, and in how many of these the gesture shown is in it."""
        return Share(int(self.pairs[:, 0].sum()), int(self.pairs.sum()))

    def to_text(self) -> str:
        """Format the counts as a table, one row per gesture shown; zeros are dots."""
        headings = ["shown \\ read", *self.labels]
        rows: list[list[str]] = [
            [label, *(str(count) if count else "." for count in row)]
            for label, row in zip(self.labels, self.counts.tolist(), strict=True)
        ]
        if self.counts[:, -1].any():
            headings.append(REFUSED)
        else:
            rows = [row[:-1] for row in rows]
        widths = [max(map(len, column)) for column in zip(headings, *rows, strict=True)]
        return "\n".join(
            "  ".join(
                [row[0].ljust(widths[0])]
                + [cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True)]
            )
            for row in [headings, *rows]
        )

    def to_dict(self) -> dict[str, Any]:
        """Convert to plain JSON types; the last column counts queries without a label."""
        return {
            "labels": list(self.labels),
            "counts": self.counts.tolist(),
            "pairs": self.pairs.tolist(),
        }
