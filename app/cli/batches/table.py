"""Table of a batch: one row for each take, or for a clip without takes, as CSV or Parquet."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from app.recognition.errors import OsgError

COLUMNS: Final[dict[str, type]] = {
    "clip": str,
    "take": int,
    "start": float,
    "end": float,
    "closed": bool,
    "label": str,
    "nearest": str,
    "confidence": float,
    "margin": float,
    "faults": str,
    "language": str,
    "revision": int,
    "profile": str,
}
"""Columns in order. ``start`` and ``end`` are seconds of the clip; ``label`` is empty for a
rejected take, all of a take for a clip without one; ``faults`` are sentences between ``; ``."""

PARQUET: Final = ".parquet"

ENDINGS: Final = (".csv", PARQUET)

Row = dict[str, Any]
"""A value or None for each of `COLUMNS`."""


def check_table(path: Path) -> None:
    """Refuse a table that could not be written at the end.

    Raises
    ------
    OsgError
        When its ending is unknown, its folder is missing, or the library for Parquet is.

    """
    if path.suffix.lower() not in ENDINGS:
        raise OsgError(f"{path} is no table; end its name in {' or '.join(ENDINGS)}")
    if not path.parent.is_dir():
        raise OsgError(f"{path.parent} is no folder; make it, or write the table elsewhere")
    if path.suffix.lower() == PARQUET:
        try:
            import pyarrow  # noqa: F401
        except ModuleNotFoundError as error:
            raise OsgError(
                f"{path} needs {error.name}, which is not installed; install it with: "
                'pip install "osg-studio[parquet]", or write a .csv'
            ) from error


def write_table(path: Path, rows: Sequence[Row]) -> None:
    """Write a table in one step, over the one that is there."""
    content = _to_parquet(rows) if path.suffix.lower() == PARQUET else _to_csv(rows)
    unfinished = path.with_name(f".{path.name}.part")
    unfinished.write_bytes(content)
    unfinished.replace(path)


def _to_csv(rows: Sequence[Row]) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, list(COLUMNS))
    writer.writeheader()
    for row in rows:
        writer.writerow({name: _to_cell(row[name]) for name in COLUMNS})
    return text.getvalue().encode("utf-8")


def _to_cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    # A spreadsheet would run a text that begins so.
    text = str(value)
    return f"'{text}" if isinstance(value, str) and text[:1] in ("=", "+", "-", "@") else text


def _to_parquet(rows: Sequence[Row]) -> bytes:
    import pyarrow
    from pyarrow import parquet

    kinds = {
        str: pyarrow.string(),
        int: pyarrow.int64(),
        float: pyarrow.float64(),
        bool: pyarrow.bool_(),
    }
    schema = pyarrow.schema([(name, kinds[kind]) for name, kind in COLUMNS.items()])
    written = io.BytesIO()
    parquet.write_table(pyarrow.Table.from_pylist(list(rows), schema), written)
    return written.getvalue()
