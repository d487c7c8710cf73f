"""Database access: SQLite with durable settings, or another URL; migrated at start."""

from __future__ import annotations

import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock

from alembic import command
from alembic.config import Config
from alembic.util import CommandError
from sqlalchemy import Connection, Engine, create_engine, event, text
from sqlalchemy.engine import make_url
from sqlalchemy.exc import DBAPIError, OperationalError
from sqlmodel import Session

from app.store.errors import StoreUnavailable

BUSY_TIMEOUT_SECONDS = 5
"""How long a writer waits for another one; transactions here take milliseconds."""

MIGRATIONS = Path(__file__).parent / "migrations"


class Database:
    """Sessions on one database.

    Parameters
    ----------
    url
        SQLAlchemy URL. For SQLite the folder of the file is made.

    Attributes
    ----------
    changes
        Grows with every committed change: what was read while it said the same is still true. It
        starts at the present moment, in nanoseconds, so that no later run repeats a number.

    """

    def __init__(self, url: str) -> None:
        parsed = make_url(url)
        self.changes = time.time_ns()
        self._counting = Lock()
        self._sqlite = parsed.get_backend_name() == "sqlite"
        if self._sqlite and parsed.database:
            Path(parsed.database).parent.mkdir(parents=True, exist_ok=True)
        self.engine: Engine = create_engine(
            parsed, connect_args={"timeout": BUSY_TIMEOUT_SECONDS} if self._sqlite else {}
        )
        if self._sqlite:
            event.listen(self.engine, "connect", _make_durable)
            event.listen(self.engine, "begin", _begin)

    def migrate(self) -> None:
        """Check the file and bring its tables to this version's.

        Raises
        ------
        StoreUnavailable
            When the file is damaged, not a database, or made by a newer version.

        """
        try:
            self._check()
            config = Config()
            config.set_main_option("script_location", MIGRATIONS.as_posix().replace("%", "%%"))
            with self.engine.begin() as connection:
                config.attributes["connection"] = connection
                command.upgrade(config, "head")
        except CommandError as error:
            raise StoreUnavailable(
                f"the database {self._name} was made by a newer version of this program "
                f"({error}); install that version, or start with another data directory"
            ) from error
        except DBAPIError as error:
            raise StoreUnavailable(
                f"the database {self._name} cannot be used: {error.orig}; "
                "restore a backup or start with another data directory"
            ) from error

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """Open a session that sees one consistent state and changes nothing."""
        with _convert_errors(), Session(self.engine, expire_on_commit=False) as session:
            yield session

    @contextmanager
    def writing(self) -> Iterator[Session]:
        """Open a session that holds the write lock from the start and commits at the end.

        Taking the lock first lets two writers wait for each other; taking it after reading would
        make SQLite refuse the second one at once.
        """
        engine = self.engine.execution_options(writing=True)
        with (
            _convert_errors(),
            engine.begin() as connection,
            Session(connection, expire_on_commit=False) as session,
        ):
            yield session
            session.flush()
        with self._counting:
            self.changes += 1

    def close(self) -> None:
        """Close every connection."""
        self.engine.dispose()

    @property
    def _name(self) -> str:
        """The address without its password."""
        return self.engine.url.render_as_string()

    def _check(self) -> None:
        if not self._sqlite:
            return
        with self.engine.connect() as connection:
            verdict = connection.execute(text("PRAGMA quick_check(1)")).scalar_one()
        if verdict != "ok":
            raise StoreUnavailable(
                f"the database {self._name} is damaged ({verdict}); "
                "restore a backup or start with another data directory"
            )


@contextmanager
def _convert_errors() -> Iterator[None]:
    """Turn what the database refuses to do for now into `StoreUnavailable`."""
    try:
        yield
    except OperationalError as error:
        raise StoreUnavailable(
            f"the database cannot answer now: {error.orig}; nothing was changed, try again"
        ) from error


def _make_durable(connection: sqlite3.Connection, _record: object) -> None:
    # Transactions are begun by `_begin`, so that "acknowledged" means "one transaction on disk".
    connection.isolation_level = None
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
