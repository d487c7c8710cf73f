"""The audit log: an entry is on the disk, in the journal while the database refuses it."""

from __future__ import annotations

import stat
from pathlib import Path

import pytest
from sqlalchemy import text

from app.store import AuditEntry, AuditStore, Database, StoreUnavailable
from app.store.audit import JOURNAL


@pytest.fixture
def audit(sqlite: Database, tmp_path: Path) -> AuditStore:
    return AuditStore(sqlite, tmp_path)


def entry(path: str) -> AuditEntry:
    return AuditEntry(
        name="Ada",
        role="edit",
        address="local",
        method="PATCH",
        path=path,
        status=200,
        request_id="r",
    )


def refuse_entries(database: Database) -> None:
    """Make the database refuse entries, as a full disk does."""
    with database.engine.begin() as connection:
        connection.execute(
            text(
                "CREATE TRIGGER refuse BEFORE INSERT ON audit_entry "
                "BEGIN SELECT RAISE(ABORT, 'full'); END"
            )
        )


def take_entries(database: Database) -> None:
    with database.engine.begin() as connection:
        connection.execute(text("DROP TRIGGER refuse"))


def paths(audit: AuditStore) -> list[str]:
    """Return what was changed, in the order of the numbers."""
    return [each.path for each in reversed(audit.newest())]


@pytest.mark.withstands(row="H22")
def test_entries_that_the_database_refuses_are_kept_and_come_before_the_next_one(
    audit: AuditStore, sqlite: Database, tmp_path: Path
) -> None:
    journal = tmp_path / JOURNAL
    audit.add(entry("/1"))
    refuse_entries(sqlite)
    first, second = entry("/2"), entry("/3")
    times = [first.time, second.time]
    audit.add(first)
    audit.add(second)
    assert stat.S_IMODE(journal.stat().st_mode) == 0o600
    take_entries(sqlite)
    audit.add(entry("/4"))
    assert paths(audit) == ["/1", "/2", "/3", "/4"]
    assert [each.time for each in audit.newest()][1:3] == times[::-1]
    assert not journal.exists()


@pytest.mark.withstands(row="H21")
def test_a_kill_between_the_commit_and_the_end_of_the_journal_repeats_no_entry(
    audit: AuditStore, sqlite: Database, tmp_path: Path
) -> None:
    refuse_entries(sqlite)
    audit.add(entry("/1"))
    audit.add(entry("/2"))
    take_entries(sqlite)
    journal = tmp_path / JOURNAL
    kept = journal.read_bytes()
    audit.import_journal()
    # A kill after the commit left the journal; one in a write left half a line.
    journal.write_bytes(kept + b'\n{"name": "A')
    refuse_entries(sqlite)
    AuditStore(sqlite, tmp_path).add(entry("/3"))
    take_entries(sqlite)
    assert paths(AuditStore(sqlite, tmp_path)) == ["/1", "/2", "/3"]


def test_an_entry_that_can_be_kept_nowhere_is_an_error(
    audit: AuditStore, sqlite: Database, tmp_path: Path
) -> None:
    refuse_entries(sqlite)
    (tmp_path / JOURNAL).mkdir()
    with pytest.raises(StoreUnavailable, match="audit log cannot be written"):
        audit.add(entry("/1"))


def test_a_database_that_does_not_exist_yet_is_not_made_for_an_entry(tmp_path: Path) -> None:
    file = tmp_path / "studio.db"
    database = Database(f"sqlite:///{file}")
    AuditStore(database, tmp_path).add(entry("/1"))
    assert not file.exists()
    database.migrate()
    assert paths(AuditStore(database, tmp_path)) == ["/1"]
    database.close()
