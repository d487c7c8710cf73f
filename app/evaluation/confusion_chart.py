"""Confusion chart: draws a confusion matrix as SVG."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

from app.evaluation.confusion import REFUSED, ConfusionMatrix

CELL = 44
"""Width and height of a cell in SVG units; a count of four digits fits."""

CHARACTER = 8
"""Assumed largest width of a character of a label at this font size."""

MOST_LABEL_WIDTH = 240
"""Largest width of a label; longer ones are condensed."""

GAP = 10

DARK = 0.9
"""Share of a row from which white text has more contrast on a cell's shade than black."""


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
