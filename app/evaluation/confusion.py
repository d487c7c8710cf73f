"""Confusion matrices: what was shown against what was read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from app.evaluation.proportion import Share

REFUSED = "(none)"
"""Heading of the column for queries that were given no label; no gesture has a label in brackets
by accident, and one that has is only printed ambiguously, not counted so."""


@dataclass(frozen=True, eq=False)
class ConfusionMatrix:
    """Counts of what was shown and what was read.

    Attributes
    ----------
    labels
        L labels in the order of the rows.
    counts
        ``(L, L + 1)``: row shown, column read; the last column counts queries without a label,
        because they were refused or showed nothing that could be compared.

    """

    labels: tuple[str, ...]
    counts: npt.NDArray[np.int64]

    @classmethod
    def of(
        cls, labels: Sequence[str], shown: Sequence[str], read: Sequence[str | None]
    ) -> ConfusionMatrix:
        """Count pairs of what was shown and what was read.

        Parameters
        ----------
        labels
            All labels that occur in `shown` or in `read`.
        shown, read
            Label shown and label read of each query, the latter None without a label.

        """
        position = {label: index for index, label in enumerate(labels)}
        counts = np.zeros((len(labels), len(labels) + 1), dtype=np.int64)
        for truth, answer in zip(shown, read, strict=True):
            counts[position[truth], len(labels) if answer is None else position[answer]] += 1
        return cls(tuple(labels), counts)

    @property
    def correct(self) -> Share:
        """Queries read as what was shown."""
        return Share(int(np.trace(self.counts)), int(self.counts.sum()))

    @property
    def refused(self) -> Share:
        """Queries without a label."""
        return Share(int(self.counts[:, -1].sum()), int(self.counts.sum()))

    def to_text(self) -> str:
        """Lay the counts out in columns, a gesture shown a row; zeros are dots."""
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
        """Return plain JSON types; the last column of the counts is of queries without a label."""
        return {"labels": list(self.labels), "counts": self.counts.tolist()}
