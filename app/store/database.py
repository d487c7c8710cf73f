"""Database access: SQLite for one server, PostgreSQL for several; migrated at start."""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from threading import Lock

from alembic import command
from alembic.config import Config
from alembic.util import CommandError
from sqlalchemy import URL, Connection, Engine, create_engine, event, text, update
from sqlalchemy.engine import make_url
from sqlalchemy.exc import (
    ArgumentError,
    DataError,
    DBAPIError,
    NoSuchModuleError,
    OperationalError,
)
from sqlmodel import Session, func, select

from app.store.models import ChangeCount


class StoreError(Exception):
    """Base of the store's errors; the message is one line for a person."""


class NotFound(StoreError):
    """Raised when an object does not exist or was deleted."""


class Conflict(StoreError):
    """Raised when somebody else has changed the object meanwhile.

    Parameters
    ----------
    message
        The expected and the actual revision, in words.
    current
        Number of the newest revision.

    """

    def __init__(self, message: str, current: int) -> None:
        super().__init__(message)
        self.current = current


class TooManyInvitations(StoreError):
    """Raised when a language has as many open invitations as are listed."""


class InvitationClosed(StoreError):
    """Raised when an invitation is not valid any more, or takes nothing more.

    Parameters
    ----------
    message
        Why, and what to do, in one line.
    code
        Stable word: ``withdrawn``, ``expired`` or ``used_up``.

    """

    def __init__(self, message: str, code: str) -> None:
        super().__init__(message)
        self.code = code


class StoreUnavailable(StoreError):
    """Raised when the database is damaged, locked or cannot be opened."""


BUSY_TIMEOUT_SECONDS = 5
"""Longest wait of a writer for another one; transactions here take milliseconds."""

WRITE_LOCK = 0x0F3C_57D1
"""Number of the PostgreSQL advisory lock that writers hold; SQLite locks its file instead."""

MIGRATIONS = Path(__file__).parent / "migrations"


class Database:
    """Sessions on one database.

    With either kind, writers take turns, and a session reads one consistent state.

    Parameters
    ----------
    url
        SQLAlchemy URL of SQLite or PostgreSQL. For SQLite the folder of the file is made.

    Raises
    ------
    StoreUnavailable
        When the URL is of another kind, or the driver is not installed.

    Attributes
    ----------
    shared
        Whether several servers may use it.
    engine
        SQLAlchemy's engine.

    """

    def __init__(self, url: str) -> None:
        try:
            parsed = make_url(url)
        except ArgumentError as error:
            raise StoreUnavailable(
                "OSG_DATABASE_URL is no URL of a database; give postgresql+psycopg://USER@HOST/NAME"
            ) from error
        self._changes = time.time_ns()
        self._counting = Lock()
        kind = parsed.get_backend_name()
        if kind not in ("sqlite", "postgresql"):
            raise StoreUnavailable(
                f"there is no support for {kind}; give postgresql+psycopg://USER@HOST/NAME, or "
                "leave OSG_DATABASE_URL out for SQLite"
            )
        self.shared = kind == "postgresql"
        if not self.shared and parsed.database:
            Path(parsed.database).parent.mkdir(parents=True, exist_ok=True)
        self.engine: Engine = _open_postgres(parsed) if self.shared else _open_sqlite(parsed)
        self._readers = self.engine
        if self.shared:
            self._readers = self.engine.execution_options(isolation_level="REPEATABLE READ")

    @property
    def file(self) -> Path | None:
        """SQLite's file; None if several servers may use the database."""
        name = self.engine.url.database
        return None if self.shared or not name else Path(name).absolute()

    @property
    def changes(self) -> int:
        """Number that grows with every committed change, by any server.

        While the number is unchanged, earlier results are valid. It is close to the present time in
        nanoseconds, so that neither a later run nor a restored backup repeats a number.
        """
        if not self.shared:
            return self._changes
        with self.reading() as session:
            return session.exec(select(ChangeCount.changes)).one()

    def migrate(self, revision: str = "head") -> None:
        """Check the database and migrate its tables to this version, or to that of a revision.

        Raises
        ------
        StoreUnavailable
            When it is damaged, not a database, not reachable, or made by a newer version.

        """
        try:
            self._check()
            config = Config()
            config.set_main_option("script_location", MIGRATIONS.as_posix().replace("%", "%%"))
            with self.engine.execution_options(writing=True).begin() as connection:
                config.attributes["connection"] = connection
                command.upgrade(config, revision)
        except CommandError as error:
            raise StoreUnavailable(
                f"the database {self._name} was made by a newer version of this program, or by "
                f"an unreleased one ({error}); install that version, or start with another data "
                "directory"
            ) from error
        except DBAPIError as error:
            remedy = "restore a backup or start with another data directory"
            if self.shared:
                remedy = "look whether it runs, and whether OSG_DATABASE_URL is right"
            reason = " ".join(str(error.orig).split())
            raise StoreUnavailable(
                f"the database {self._name} cannot be used: {reason}; {remedy}"
            ) from error

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """Open a session that sees one consistent state and changes nothing."""
        with _convert_errors(), Session(self._readers, expire_on_commit=False) as session:
            yield session

    @contextmanager
    def writing(self, *, counted: bool = True) -> Iterator[Session]:
        """Open a session that holds the write lock from the start and commits at the end.

        What is changed of rows that it loads is stored as well; only new rows are added to it.
        With the lock taken first, a second writer waits; with the lock taken after reading, SQLite
        would refuse the second writer at once. `counted` is False for changes that no list shows.
        """
        engine = self.engine.execution_options(writing=True)
        with (
            _convert_errors(),
            engine.begin() as connection,
            Session(connection, expire_on_commit=False) as session,
        ):
            yield session
            session.flush()
            if counted and self.shared:
                number = func.greatest(ChangeCount.changes + 1, time.time_ns())
                session.execute(update(ChangeCount).values(changes=number))
        if counted:
            with self._counting:
                self._changes += 1

    def close(self) -> None:
        """Close every connection."""
        self.engine.dispose()

    @property
    def _name(self) -> str:
        """The address without its password."""
        return self.engine.url.render_as_string()

    def _check(self) -> None:
        if self.shared:
            return
        with self.engine.connect() as connection:
            verdict = connection.execute(text("PRAGMA quick_check(1)")).scalar_one()
        if verdict != "ok":
            raise StoreUnavailable(
                f"the database {self._name} is damaged ({verdict}); "
                "restore a backup or start with another data directory"
            )


class DatabaseStore:
    """Base of the stores, each of which keeps the rows of its kind in `database`."""

    def __init__(self, database: Database) -> None:
        self._database = database

    @property
    def changes(self) -> int:
        """Grows with every change of the database, see `Database`."""
        return self._database.changes


def moment_of(session: Session) -> datetime:
    """Return the present time of the database, because the servers' clocks may differ."""
    moment: datetime = session.execute(select(func.current_timestamp())).scalar_one()
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment


@contextmanager
def _convert_errors() -> Iterator[None]:
    """Convert temporary errors to `StoreUnavailable`, and those of invalid values to `NotFound`."""
    try:
        yield
    except OperationalError as error:
        raise StoreUnavailable(
            f"the database cannot answer now: {error.orig}; nothing was changed, try again"
        ) from error
    except DataError as error:
        # PostgreSQL refuses texts with NUL and integers that are too large; SQLite finds no row.
        raise NotFound("there is nothing of that name or number") from error


def _open_sqlite(url: URL) -> Engine:
    engine = create_engine(url, connect_args={"timeout": BUSY_TIMEOUT_SECONDS})
    event.listen(engine, "connect", _make_durable)
    event.listen(engine, "begin", _begin)
    return engine


def _open_postgres(url: URL) -> Engine:
    options = f"-c lock_timeout={round(BUSY_TIMEOUT_SECONDS * 1000)} -c timezone=UTC"
    try:
        engine = create_engine(
            url,
            connect_args={"options": options, "connect_timeout": BUSY_TIMEOUT_SECONDS},
            # A connection that the database closed, for example at a restart, is replaced silently.
            pool_pre_ping=True,
        )
    except (NoSuchModuleError, ModuleNotFoundError) as error:
        raise StoreUnavailable(
            f"the driver of {url.drivername} is not installed ({error}); "
            'install it with: pip install "osg-studio[postgres]"'
        ) from error
    event.listen(engine, "begin", _take_turn)
    return engine


def _take_turn(connection: Connection) -> None:
    """Wait until no other server writes; the lock ends with the transaction."""
    if connection.get_execution_options().get("writing", False):
        # Later statements see all earlier commits (PostgreSQL's READ COMMITTED).
        connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({WRITE_LOCK})")


def _make_durable(connection: sqlite3.Connection, _record: object) -> None:
    # Transactions are begun by `_begin`, so that "acknowledged" means "one transaction on disk".
    connection.isolation_level = None
    # SQLite's own `lower` knows only ASCII; the search for names ignores case.
    connection.create_function("lower", 1, str.lower, deterministic=True)
    for pragma in (
        "journal_mode=WAL",
        "synchronous=FULL",
        "foreign_keys=ON",
        f"busy_timeout={BUSY_TIMEOUT_SECONDS * 1000}",
    ):
        connection.execute(f"PRAGMA {pragma}")


def _begin(connection: Connection) -> None:
    writing = connection.get_execution_options().get("writing", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writing else "BEGIN")
