"""Checked copy: a new database with the rows of one that a stranger may have made.

Nothing of the received file is kept but its values, and nothing in it is run: it is opened for
reading, its tables must be those that a version of this program makes, and each value is checked.
"""

from __future__ import annotations

import json
import math
import re
import sqlite3
from collections.abc import Callable
from contextlib import closing
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any, Final

from pydantic import TypeAdapter
from sqlalchemy import (
    Boolean,
    Column,
    Connection,
    Float,
    Integer,
    String,
    insert,
    select,
    text,
    update,
)
from sqlmodel import AutoString, Session, SQLModel, col

from app.bags.topic_summary import TopicSummary
from app.clip_sources import SOURCES, ReadOptions
from app.recognition.errors import OsgError
from app.store.database import Database
from app.store.invitations import LONGEST_DAYS
from app.store.models import (
    OWN_ID,
    AuditEntry,
    ChangeCount,
    Clip,
    Invitation,
    Json,
    LanguageRecord,
    SignIn,
    UploadReservation,
    UtcDateTime,
    now,
)

AT_ONCE: Final = 100
"""Rows read and written at a time: the document of a language has up to 64 MB, most have 100 kB."""

OF_A_SERVER: Final = (ChangeCount, SignIn, UploadReservation)
"""Tables that belong to the running servers and not to the library: their rows are not copied. A
file that is copied as it is (`archive`) loses the sign-ins."""


OTHER_CLOCK: Final = timedelta(days=1)
"""Longest time by which the clock of another machine may be fast."""

_AHEAD: Final = {"invitation.expires": timedelta(days=LONGEST_DAYS)}
"""Longest time by which a time may lie in the future; of other columns none does."""

_MOST: Final = 2**53 - 1
"""Largest integer that browsers read unchanged."""

_VIDEO_TYPE: Final = re.compile(r"video/[a-z0-9-]{1,40}")
_STRINGS: Final = TypeAdapter(tuple[str, ...])
_PAIR: Final = TypeAdapter(tuple[str, str])
_REVISION: Final = re.compile(r"\d{4}")
_READING: Final = frozenset({sqlite3.SQLITE_SELECT, sqlite3.SQLITE_READ, sqlite3.SQLITE_PRAGMA})
_OF_SQLITE: Final = "sqlite_"


def copy_checked(received: Path, target: Path) -> frozenset[str]:
    """Copy the rows of a received SQLite file into a new one of this version.

    Returns
    -------
    The ids of the clips.

    Raises
    ------
    OsgError
        When the file is damaged, has other tables than this program makes, or a value that this
        program never writes.
    StoreUnavailable
        When a newer version has made it.

    """
    try:
        with closing(_open(received)) as source, closing(Database(f"sqlite:///{target}")) as copy:
            copy.migrate(_revision(source))
            with closing(sqlite3.connect(target)) as writing:
                _copy(source, writing)
            copy.migrate()
            clips = _check(copy)
            _withdraw_invitations(copy)
        with closing(sqlite3.connect(target)) as finished:
            # No journal beside the file: it is moved alone.
            finished.execute("PRAGMA journal_mode=DELETE")
    except OsgError:
        raise
    except (sqlite3.Error, ValueError, TypeError, OverflowError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise _refusal(f"cannot be read ({reason})") from error
    return clips


def _open(received: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(f"{received.resolve().as_uri()}?mode=ro&immutable=1", uri=True)
    connection.execute("PRAGMA trusted_schema=OFF")
    connection.execute("PRAGMA cell_size_check=ON")
    connection.set_authorizer(
        lambda action, *_: sqlite3.SQLITE_OK if action in _READING else sqlite3.SQLITE_DENY
    )
    return connection


def _revision(source: sqlite3.Connection) -> str:
    """Return the version of the tables, after a check that there are only tables and indexes."""
    for kind, name, page in source.execute("SELECT type, name, rootpage FROM sqlite_master"):
        if kind not in ("table", "index") or not page:
            raise _refusal(f"has a {kind} {_shown(name)} that acts on its own")
    versions = source.execute("SELECT version_num FROM alembic_version").fetchall()
    if len(versions) != 1 or not _REVISION.fullmatch(str(versions[0][0])):
        raise _refusal("does not say its version")
    return str(versions[0][0])


def _copy(source: sqlite3.Connection, target: sqlite3.Connection) -> None:
    """Copy all values of the tables, which must be the same in both."""
    known = _tables(target)
    if other := known ^ _tables(source):
        raise _refusal(f"has other tables than this program: {_shown(min(other))}")
    for name in known:
        columns = _columns(target, name)
        if sorted(_columns(source, name)) != sorted(columns):
            raise _refusal(f"has other columns in table {name} than this program")
        listed = ", ".join(f'"{column}"' for column in columns)
        places = ", ".join("?" * len(columns))
        target.execute(f'DELETE FROM "{name}"')
        rows = source.execute(f'SELECT {listed} FROM "{name}"')
        target.executemany(f'INSERT INTO "{name}" ({listed}) VALUES ({places})', rows)
    if (broken := target.execute("PRAGMA foreign_key_check").fetchone()) is not None:
        raise _refusal(f"has a row in table {broken[0]} that belongs to nothing")
    target.commit()


def _tables(connection: sqlite3.Connection) -> set[str]:
    rows = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")
    return {str(name) for (name,) in rows if not str(name).startswith(_OF_SQLITE)}


def _columns(connection: sqlite3.Connection, table: str) -> list[str]:
    """Return the columns of one of our tables, without those that are computed."""
    rows = connection.execute(f'PRAGMA table_xinfo("{table}")')
    return [str(name) for _, name, *_, hidden in rows if not hidden]


def _check(copy: Database) -> frozenset[str]:
    """Check all values; return the ids of the clips."""
    latest = now() + OTHER_CLOCK
    with copy.reading() as session:
        for table in SQLModel.metadata.sorted_tables:
            rows = session.connection().execution_options(yield_per=AT_ONCE).execute(select(table))
            for row in rows.mappings():
                for column in table.columns:
                    value = row[column.name]
                    if value is not None and not _is_ours(column, value, latest):
                        raise _refusal(
                            f"has {_shown(value)} as {column.name} of a {table.name}, which this "
                            "program never writes"
                        )
        return frozenset(session.connection().execute(select(Clip.id)).scalars())  # type: ignore[call-overload]


def _withdraw_invitations(copy: Database) -> None:
    """End all invitations: whoever made the backup may have planted the digest of a token."""
    with copy.writing() as session:
        still_open = col(Invitation.withdrawn).is_(None)
        session.exec(update(Invitation).where(still_open).values(withdrawn=now()))


def _is_ours(column: Column[Any], value: object, latest: datetime) -> bool:
    """Return whether a value may be this program's own."""
    place = f"{column.table.name}.{column.name}"
    match column.type:
        case UtcDateTime():
            ahead = _AHEAD.get(place, timedelta())
            return isinstance(value, datetime) and value <= latest + ahead
        case Boolean():
            return isinstance(value, bool)
        case Float():
            return isinstance(value, int | float) and math.isfinite(value)
        case Integer():
            return isinstance(value, int) and 0 <= value <= _MOST
        case Json():
            return _JSON[place].validate_python(value) is not None
        case String() | AutoString():
            if not isinstance(value, str):
                return False
            if column.type.length == 32 and (column.name == "id" or column.name.endswith("_id")):
                return OWN_ID.fullmatch(value) is not None
            return place not in _TEXTS or _TEXTS[place](value)
    return False


def _is_json_of(kind: type) -> Callable[[str], bool]:
    return lambda text: isinstance(json.loads(text), kind)


_TEXTS: Final[dict[str, Callable[[str], bool]]] = {
    "clip.source": lambda text: text in {source.name for source in SOURCES},
    # As another type, a player would show the file as a page.
    "clip.media_type": lambda text: _VIDEO_TYPE.fullmatch(text) is not None,
    "language_revision.document": _is_json_of(dict),
    "recognition.result": _is_json_of(dict),
}
"""Checks of the texts that become paths or headers or are parsed; they may raise ValueError."""

_JSON: Final[dict[str, TypeAdapter[Any]]] = {
    "clip.topics": TypeAdapter(tuple[TopicSummary, ...]),
    "clip.options": TypeAdapter(ReadOptions),
    "job.warnings": _STRINGS,
    "job.salute_warnings": _STRINGS,
    "language_revision.labels": _STRINGS,
    "labelled_take.former": _STRINGS,
    "labelled_result.pair": _PAIR,
    "practice_take.pair": _PAIR,
}
"""What the columns of JSON hold."""


def _shown(value: object) -> str:
    return repr(value)[:80]


def _refusal(reason: str) -> OsgError:
    return OsgError(f"the database in the backup {reason}; use another backup")


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
