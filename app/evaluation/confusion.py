"""Confusion matrix: counts of gestures shown against labels recognised."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from app.evaluation.proportion import Share

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
        label, because they were rejected or could not be compared.

    """

    labels: tuple[str, ...]
    counts: npt.NDArray[np.int64]

    @classmethod
    def of(
        cls, labels: Sequence[str], shown: Sequence[str], read: Sequence[str | None]
    ) -> ConfusionMatrix:
        """Count pairs of labels shown and recognised.

        Parameters
        ----------
        labels
            All labels that occur in `shown` or in `read`.
        shown, read
            Label shown and label recognised of each query; None when rejected.

        """
        position = {label: index for index, label in enumerate(labels)}
        counts = np.zeros((len(labels), len(labels) + 1), dtype=np.int64)
        for truth, answer in zip(shown, read, strict=True):
            counts[position[truth], len(labels) if answer is None else position[answer]] += 1
        return cls(tuple(labels), counts)

    @property
    def correct(self) -> Share:
        """Queries recognised as the gesture shown."""
        return Share(int(np.trace(self.counts)), int(self.counts.sum()))

    @property
    def refused(self) -> Share:
        """Queries without a label."""
        return Share(int(self.counts[:, -1].sum()), int(self.counts.sum()))

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
        return {"labels": list(self.labels), "counts": self.counts.tolist()}
