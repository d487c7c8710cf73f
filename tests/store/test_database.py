"""The database: durable, one writer at a time, migrated at start, honest when it is broken."""

import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import text
from sqlmodel import col, func, select

from app.store import ClipStore, Database, LanguageStore, NotFound, StoreUnavailable
from app.store.models import SeededSample
from tests.postgres import Cluster


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
def test_every_connection_is_durable(sqlite: Database, pragma: str, value: str | int) -> None:
    with sqlite.engine.connect() as connection:
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


def test_what_was_written_is_there_after_opening_again(
    database: Database, database_url: str
) -> None:
    with database.writing() as session:
        session.add(SeededSample(name="kept"))
    database.close()
    again = Database(database_url)
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


def test_a_locked_database_is_unavailable_and_works_again_later(
    database_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = Database(database_url)
    one.migrate()
    monkeypatch.setattr("app.store.database.BUSY_TIMEOUT_SECONDS", 0.02)
    other = Database(database_url)
    with one.writing(), pytest.raises(StoreUnavailable, match="try again"):
        add(other, "never")
    add(other, "later")
    assert count(one) == 1


def test_a_file_that_is_no_database_is_named(tmp_path: Path) -> None:
    path = tmp_path / "studio.db"
    path.write_bytes(b"this is not a database, it only has its name" * 100)
    with pytest.raises(StoreUnavailable, match=r"studio\.db.*restore a backup"):
        Database(f"sqlite:///{path}").migrate()


def test_a_damaged_database_is_refused_rather_than_used(sqlite: Database, tmp_path: Path) -> None:
    with sqlite.writing() as session:
        session.add_all(SeededSample(name=f"{index:04d}" * 40) for index in range(500))
    sqlite.close()
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


def test_a_change_by_another_server_is_counted(postgres: Cluster) -> None:
    url = postgres.new_database()
    database, other = Database(url), Database(url)
    database.migrate()
    before = other.changes
    add(database, "one")
    assert before < other.changes == database.changes
    after = other.changes
    with database.writing(counted=False) as session:
        session.add(SeededSample(name="shown in no list"))
    assert other.changes == after
    database.close()
    other.close()


def test_what_a_session_reads_is_one_state(database: Database) -> None:
    with database.reading() as session:
        query = select(func.count()).select_from(SeededSample)
        assert session.exec(query).one() == 0
        add(database, "meanwhile")
        assert session.exec(query).one() == 0
    assert count(database) == 1


def test_a_database_that_was_restarted_is_used_again(postgres: Cluster) -> None:
    database = Database(postgres.new_database())
    database.migrate()
    add(database, "before")
    postgres.stop()
    with pytest.raises(StoreUnavailable, match="try again"):
        add(database, "never")
    with pytest.raises(StoreUnavailable, match="whether it runs"):
        database.migrate()
    postgres.start()
    add(database, "after")
    assert count(database) == 2
    database.close()


@pytest.mark.withstands(row="H18")
def test_an_id_that_no_text_can_be_names_nothing(clips: ClipStore, database: Database) -> None:
    with pytest.raises(NotFound):
        clips.get("a\x00b")
    with pytest.raises(NotFound):
        LanguageStore(database).get("language", 2**40)


def test_many_servers_that_start_at_once_migrate_once(postgres: Cluster) -> None:
    url = postgres.new_database()
    with ThreadPoolExecutor(4) as servers:
        for started in [servers.submit(Database(url).migrate) for _ in range(4)]:
            started.result()


@pytest.mark.parametrize(
    ("url", "remedy"),
    [
        ("postgresql+asyncpgx://localhost/osg", "osg-studio\\[postgres\\]"),
        ("mysql://localhost/osg", "no support for mysql"),
        ("my database", "OSG_DATABASE_URL is no URL"),
    ],
)
def test_a_url_that_cannot_be_used_is_refused_with_a_way_out(url: str, remedy: str) -> None:
    with pytest.raises(StoreUnavailable, match=remedy):
        Database(url)


def test_without_the_driver_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with pytest.raises(StoreUnavailable, match=r'pip install "osg-studio\[postgres\]"'):
        Database("postgresql+psycopg://localhost/osg")
