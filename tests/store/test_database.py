"""The database: durable, one writer at a time, migrated at start, honest when it is broken."""

import threading
from pathlib import Path

import pytest
from sqlalchemy import text
from sqlmodel import col, func, select

from app.store import Database, StoreUnavailable
from app.store.models import SeededSample


def count(database: Database) -> int:
    with database.reading() as session:
        return session.exec(select(func.count()).select_from(SeededSample)).one()


def add(database: Database, name: str) -> None:
    with database.writing() as session:
        session.add(SeededSample(name=name))


@pytest.mark.parametrize(
    ("pragma", "value"),
    [("journal_mode", "wal"), ("synchronous", 2), ("foreign_keys", 1), ("busy_timeout", 5000)],
)
def test_every_connection_is_durable(database: Database, pragma: str, value: str | int) -> None:
    with database.engine.connect() as connection:
        assert connection.execute(text(f"PRAGMA {pragma}")).scalar_one() == value


def test_a_failure_within_a_transaction_leaves_nothing(database: Database) -> None:
    def write_half() -> None:
        with database.writing() as session:
            session.add(SeededSample(name="half"))
            session.flush()
            raise KeyError

    with pytest.raises(KeyError):
        write_half()
    assert count(database) == 0


def test_what_was_written_is_there_after_opening_again(database: Database, tmp_path: Path) -> None:
    with database.writing() as session:
        session.add(SeededSample(name="kept"))
    database.close()
    again = Database(f"sqlite:///{tmp_path / 'studio.db'}")
    again.migrate()
    assert count(again) == 1
    again.close()


def test_writers_wait_for_each_other_and_lose_nothing(database: Database) -> None:
    with database.writing() as session:
        session.add(SeededSample(name="0"))
    failures = []

    def append() -> None:
        try:
            for _ in range(10):
                with database.writing() as session:
                    newest = session.exec(select(func.max(col(SeededSample.name)))).one()
                    session.add(SeededSample(name=f"{int(newest) + 1:03d}"))
        except Exception as error:
            failures.append(error)

    threads = [threading.Thread(target=append) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
    assert count(database) == 41


def test_a_locked_database_is_unavailable_and_works_again_later(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'studio.db'}"
    one, other = Database(url), Database(url)
    one.migrate()
    with other.engine.connect() as impatient:
        impatient.exec_driver_sql("PRAGMA busy_timeout=20")
    with one.writing(), pytest.raises(StoreUnavailable, match="try again"):
        add(other, "never")
    add(other, "later")
    assert count(one) == 1


def test_a_file_that_is_no_database_is_named(tmp_path: Path) -> None:
    path = tmp_path / "studio.db"
    path.write_bytes(b"this is not a database, it only has its name" * 100)
    with pytest.raises(StoreUnavailable, match=r"studio\.db.*restore a backup"):
        Database(f"sqlite:///{path}").migrate()


def test_a_damaged_database_is_refused_rather_than_used(database: Database, tmp_path: Path) -> None:
    with database.writing() as session:
        session.add_all(SeededSample(name=f"{index:04d}" * 40) for index in range(500))
    database.close()
    path = tmp_path / "studio.db"
    content = bytearray(path.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 20_000] = b"\xff" * 20_000
    path.write_bytes(content)
    with pytest.raises(StoreUnavailable):
        Database(f"sqlite:///{path}").migrate()


def test_a_database_of_a_newer_version_is_refused(database: Database) -> None:
    with database.engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = 'from-the-future'"))
    with pytest.raises(StoreUnavailable, match="newer version"):
        database.migrate()
