"""Confusion matrix of a recogniser, with its shares and intervals, as text and as chart."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
import numpy.typing as npt

from app.evaluation.share import Share

CELL = 44
"""Width and height of a cell in SVG units; a count of four digits fits."""

CHARACTER = 8
"""Assumed largest width of a character of a label at this font size."""

MOST_LABEL_WIDTH = 240
"""Largest width of a label; longer ones are condensed."""

GAP = 10

DARK = 0.9
"""Share of a row from which white text has more contrast on a cell's shade than black."""


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


def confusion_svg(matrix: ConfusionMatrix, title: str) -> str:
    """Draw a confusion matrix.

    Parameters
    ----------
    matrix
        The matrix; rows are shown, columns recognised.
    title
        Title above the matrix, also its accessible name.

    Returns
    -------
    An SVG document. A cell's shade is its share of the row, green on the diagonal and red
    elsewhere; the count is printed in it, so that the chart is readable without colour.

    """
    columns = [*matrix.labels, REFUSED]
    if not matrix.counts[:, -1].any():
        columns.pop()
    labels = min(MOST_LABEL_WIDTH, CHARACTER * max(map(len, columns)))
    left, top = labels + 2 * GAP, labels + 5 * GAP
    width = max(left + CELL * len(columns) + GAP, CHARACTER * len(title) + 2 * GAP)
    height = top + CELL * len(matrix.labels) + 4 * GAP
    name = escape(title)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" '
        f'aria-label="{name}" font-family="sans-serif" font-size="13">',
        f"<title>{name}</title>",
        f'<rect width="{width}" height="{height}" fill="white"/>',
        f'<text x="{GAP}" y="{2 * GAP}" font-size="15">{name}</text>',
        *_headings(matrix.labels, columns, left, top, labels),
        *_cells(matrix, len(columns), left, top),
        f'<text x="{left}" y="{height - GAP}" fill="#555">row: shown, column: read; '
        f"{matrix.correct.correct} of {matrix.correct.asked} correct</text>",
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _headings(
    rows: tuple[str, ...], columns: list[str], left: int, top: int, space: int
) -> Iterator[str]:
    for index, label in enumerate(rows):
        y = top + CELL * index + CELL // 2 + 5
        yield f'<text x="{left - GAP}" y="{y}" text-anchor="end"{_fit(label, space)}</text>'
    for index, label in enumerate(columns):
        x, y = left + CELL * index + CELL // 2 + 5, top - GAP
        yield f'<text transform="translate({x} {y}) rotate(-90)"{_fit(label, space)}</text>'


def _fit(label: str, space: int) -> str:
    """Return the end of a text's start tag and its content, condensed when too wide."""
    squeezed = f' textLength="{space}" lengthAdjust="spacingAndGlyphs"'
    return f"{squeezed if CHARACTER * len(label) > space else ''}>{escape(label)}"


def _cells(matrix: ConfusionMatrix, columns: int, left: int, top: int) -> Iterator[str]:
    for row, counts in enumerate(matrix.counts.tolist()):
        for column, count in enumerate(counts[:columns]):
            share = count / max(1, sum(counts))
            hue = "27,120,55" if row == column else "178,24,43"
            x, y = left + CELL * column, top + CELL * row
            yield (
                f'<rect x="{x}" y="{y}" width="{CELL}" height="{CELL}" '
                f'fill="rgb({hue})" fill-opacity="{share:.3f}" stroke="#ccc"/>'
            )
            if count:
                ink = "white" if share > DARK else "black"
                yield (
                    f'<text x="{x + CELL // 2}" y="{y + CELL // 2 + 5}" text-anchor="middle" '
                    f'fill="{ink}">{count}</text>'
                )
