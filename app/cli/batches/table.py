"""Table of a batch as a file: CSV or Parquet."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from app.evaluation.take_table import COLUMNS, Row, write_csv
from app.recognition.errors import OsgError

PARQUET: Final = ".parquet"

ENDINGS: Final = (".csv", PARQUET)


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
    """Write a table in one step, in place of an existing one."""
    content = (
        _to_parquet(rows) if path.suffix.lower() == PARQUET else write_csv(rows).encode("utf-8")
    )
    unfinished = path.with_name(f".{path.name}.part")
    unfinished.write_bytes(content)
    unfinished.replace(path)


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
