"""Row copy: copies all rows of a database to a database of another kind.

A backup of SQLite has the file itself (`archive`).
"""

from __future__ import annotations

from typing import Final

from sqlalchemy import Connection, insert, select, text
from sqlmodel import Session, SQLModel, col

from app.recognition.errors import OsgError
from app.store.models import (
    AuditEntry,
    ChangeCount,
    Clip,
    LanguageRecord,
    SignIn,
    UploadReservation,
)

AT_ONCE: Final = 100
"""Rows read and written at a time: the document of a language has up to 64 MB, most have 100 kB."""

OF_A_SERVER: Final = (ChangeCount, SignIn, UploadReservation)
"""Tables that belong to the running servers and not to the library."""


def copy_rows(source: Session, target: Session) -> None:
    """Copy the rows of all tables; both databases must have the tables of this version.

    Raises
    ------
    OsgError
        When the target holds clips or languages.

    """
    for kept in (col(Clip.id), col(LanguageRecord.id)):
        if target.execute(select(kept).limit(1)).first() is not None:
            raise OsgError(
                "the database of OSG_DATABASE_URL holds clips or languages already; "
                "name an empty one, which no server has used"
            )
    reading, writing = source.connection(), target.connection()
    # Sorted, because later tables refer to earlier ones.
    for table in SQLModel.metadata.sorted_tables:
        if table.name in {each.__tablename__ for each in OF_A_SERVER}:
            continue
        rows = reading.execution_options(yield_per=AT_ONCE).execute(select(table))
        for some in rows.mappings().partitions():
            writing.execute(insert(table), [dict(row) for row in some])
    if writing.dialect.name == "postgresql":
        _continue_numbers(writing)


def _continue_numbers(connection: Connection) -> None:
    """Continue PostgreSQL's sequences after the numbers of the copied entries."""
    table = AuditEntry.__tablename__
    connection.execute(
        text(
            f"SELECT setval(pg_get_serial_sequence('{table}', 'id'), "
            f"(SELECT coalesce(max(id), 0) + 1 FROM {table}), false)"
        )
    )
