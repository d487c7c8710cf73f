"""Table of takes: one row for each take of several clips, or for a clip without takes."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any, Final

from app.evaluation.confusion import NONE
from app.recognition import Recognition, Recognizer, Recording, Take
from app.recognition.text.wording import join_words

COLUMNS: Final[dict[str, type]] = {
    "clip": str,
    "take": int,
    "start": float,
    "end": float,
    "closed": bool,
    "label": str,
    "nearest": str,
    "runner_up": str,
    "confidence": float,
    "margin": float,
    "expected": str,
    "faults": str,
    "language": str,
    "revision": int,
    "profile": str,
    "pair": str,
}
"""Columns in order. ``start`` and ``end`` are seconds of the clip; ``label`` is empty for a take
that is rejected or lies between two gestures, which ``pair`` then has as "circle or square"; all
values of a take are empty for a clip without takes; ``expected`` is empty if no test set has the
take, and ``-`` where it shows none of the gestures; ``faults`` are sentences separated by
``; ``."""

NO_TAKE: Final = "no take found"

Row = dict[str, Any]
"""A value or None for each of `COLUMNS`."""


def rows_of_clip(
    clip: str,
    recognizer: Recognizer,
    recording: Recording,
    results: Sequence[tuple[Take, Recognition]],
    expected: Mapping[int, str] | None = None,
) -> list[Row]:
    """Return the rows of a clip's takes, or one row for a clip without takes.

    Parameters
    ----------
    clip
        Name of the clip.
    recognizer
        Recogniser of the takes.
    recording
        Recording of the clip.
    results
        Takes with their recognitions.
    expected
        Known labels, by number of the take from 1.

    """
    warnings = recording.list_warnings(recognizer.language.trigger)
    if not results:
        return [row_of_fault(clip, recognizer, *warnings, NO_TAKE)]
    known = expected or {}
    return [
        _constant(clip, recognizer)
        | {
            "take": number,
            "start": round(take.start, 3),
            "end": round(take.end, 3),
            "closed": take.closed,
            "label": result.label,
            "nearest": result.nearest,
            "runner_up": result.runner_up,
            "confidence": round(result.confidence, 4),
            "margin": round(result.margin, 4) if abs(result.margin) < 1e300 else None,
            "expected": known.get(number),
            "faults": "; ".join([*warnings, *result.findings, *filter(None, [result.fault])]),
            "pair": None if result.pair is None else join_words(result.pair, last="or"),
        }
        for number, (take, result) in enumerate(results, start=1)
    ]


def row_of_fault(clip: str, recognizer: Recognizer, *faults: str) -> Row:
    """Return the row of a clip without takes, or of one that cannot be read."""
    return dict.fromkeys(COLUMNS) | _constant(clip, recognizer) | {"faults": "; ".join(faults)}


def write_csv(rows: Sequence[Row]) -> str:
    """Write rows as comma-separated values under a header."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, list(COLUMNS))
    writer.writeheader()
    for row in rows:
        writer.writerow({name: _to_cell(row[name]) for name in COLUMNS})
    return text.getvalue()


def _constant(clip: str, recognizer: Recognizer) -> Row:
    language = recognizer.language
    return {
        "clip": clip,
        "language": language.name,
        "revision": language.revision,
        "profile": recognizer.profile,
    }


def _to_cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    # A spreadsheet would run a text with this beginning as a formula, but not a lone minus.
    text = str(value)
    if text == NONE:
        return text
    return f"'{text}" if isinstance(value, str) and text[:1] in ("=", "+", "-", "@") else text
