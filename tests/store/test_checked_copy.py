"""A backup by a stranger is restored as what this program writes itself, or refused in one line."""

from __future__ import annotations

import hashlib
import json
import os
import sqlite3
import stat
import sys
import zipfile
from collections.abc import Callable
from contextlib import closing
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any, get_args

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy
from sqlalchemy import Boolean, Column, Float, Integer, String, delete, insert
from sqlmodel import AutoString, SQLModel, select

from app.api.http.schemas.invitations import TakeStatus
from app.clip_sources import SOURCES
from app.recognition.errors import OsgError
from app.store import Clip, ClipStore, Database, LanguageStore
from app.store.backup import DATABASE, restore_backup, write_backup
from app.store.backup.checked_copy import OF_A_SERVER
from app.store.invitations import LONGEST_DAYS, InvitationStore
from app.store.models import UPRIGHT, JobStatus, UtcDateTime, new_id, now
from app.store.tokens import digest
from tests.postgres import Cluster
from tests.store.conftest import add_clip
from tests.store.new_database import put_database

CLIP_ID, LANGUAGE_ID = "0" * 31 + "1", "0" * 31 + "2"
MOMENT = "2026-01-01 00:00:00"


@pytest.fixture
def kept(tmp_path: Path) -> Path:
    """Return the backup of a library with a clip."""
    folder, target = tmp_path / "data", tmp_path / "kept.zip"
    folder.mkdir()
    put_database(folder / DATABASE)
    with closing(Database(f"sqlite:///{folder / DATABASE}")) as database:
        database.migrate()
        add_clip(ClipStore(database, folder / "clips"))
    assert write_backup(folder, target) == 1
    return target


def changed(kept: Path, change: Callable[[sqlite3.Connection], object]) -> Path:
    """Return a backup with another database and right digests."""
    hostile = kept.with_name("hostile.zip")
    database = kept.with_name("changed.db")
    with zipfile.ZipFile(kept) as archive, zipfile.ZipFile(hostile, "w") as written:
        database.write_bytes(archive.read(DATABASE))
        with closing(sqlite3.connect(database)) as connection:
            change(connection)
            connection.commit()
        content = database.read_bytes()
        manifest = json.loads(archive.read("manifest.json"))
        manifest["files"][DATABASE] = hashlib.sha256(content).hexdigest()
        for name in archive.namelist():
            if name not in (DATABASE, "manifest.json"):
                written.writestr(name, archive.read(name))
        written.writestr(DATABASE, content)
        written.writestr("manifest.json", json.dumps(manifest))
    return hostile


STATEMENTS = [
    "UPDATE clip SET id = '../../victim', deleted = '2020-01-01 00:00:00'",
    "UPDATE clip SET id = upper(id)",
    "UPDATE job SET id = '/etc'",
    "UPDATE clip SET source = '../../../secret'",
    "UPDATE clip SET source = 'unknown'",
    "UPDATE clip SET deleted = '2999-01-01 00:00:00'",
    "UPDATE clip SET created = 'yesterday'",
    "UPDATE clip SET topics = '{'",
    "UPDATE clip SET topics = '{}'",
    "UPDATE clip SET topics = '[1, {}]'",
    "UPDATE clip SET media_type = 'text/html'",
    "UPDATE clip SET media_type = 'video/mp4' || char(10) || 'Set-Cookie: a=b'",
    "UPDATE clip SET frames = 9223372036854775807",
    "UPDATE job SET warnings = '[1, {}]'",
    "UPDATE clip SET options = '{\"unknown\": 1}'",
    "UPDATE clip SET name = x'00ff'",
    "UPDATE clip SET size = -1000000",
    "UPDATE clip SET width = 'wide'",
    "UPDATE clip SET duration = 9e999",
    "UPDATE job SET clip_id = '00000000000000000000000000000009'",
    "CREATE TRIGGER t AFTER INSERT ON clip BEGIN DELETE FROM language; END",
    "CREATE VIEW v AS SELECT * FROM clip",
    "CREATE VIRTUAL TABLE f USING fts5(x)",
    "CREATE TABLE more (x)",
    "DROP TABLE language_revision",
    "ALTER TABLE clip ADD COLUMN more TEXT",
    "ALTER TABLE clip DROP COLUMN owner",
    "DROP TABLE job; CREATE VIEW job AS SELECT * FROM clip",
    "UPDATE alembic_version SET version_num = 'head'",
    "UPDATE alembic_version SET version_num = '../../evil'",
    "DELETE FROM alembic_version",
]


@pytest.mark.withstands(row="H32")
@pytest.mark.parametrize("statement", STATEMENTS)
def test_what_this_program_never_writes_is_refused_in_one_line(
    kept: Path, tmp_path: Path, statement: str
) -> None:
    def change(connection: sqlite3.Connection) -> None:
        connection.executescript("PRAGMA foreign_keys=OFF; DROP INDEX IF EXISTS ix_clip_owner;")
        connection.executescript(statement)

    with pytest.raises(OsgError, match="the database in the backup") as refused:
        restore_backup(changed(kept, change), tmp_path / "new")
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "new" / DATABASE).exists()
    assert not (tmp_path / "new" / "clips").exists()


def test_a_computed_column_is_refused(kept: Path, tmp_path: Path) -> None:
    def change(connection: sqlite3.Connection) -> None:
        connection.execute("DROP TABLE seeded_sample")
        connection.execute("CREATE TABLE seeded_sample (name TEXT AS (hex(9)), created TEXT)")

    with pytest.raises(OsgError, match="other columns in table seeded_sample"):
        restore_backup(changed(kept, change), tmp_path / "new")


def test_nothing_of_the_received_tables_is_kept_but_the_values(kept: Path, tmp_path: Path) -> None:
    def change(connection: sqlite3.Connection) -> None:
        connection.execute("CREATE INDEX strange ON clip (name, size)")
        connection.execute("PRAGMA user_version = 77")

    folder = tmp_path / "new"
    assert restore_backup(changed(kept, change), folder) == 1
    with closing(sqlite3.connect(folder / DATABASE)) as connection:
        named = connection.execute("SELECT name FROM sqlite_master WHERE name = 'strange'")
        assert named.fetchall() == []
        assert connection.execute("PRAGMA user_version").fetchone() == (0,)
    assert not list(folder.glob("studio.db-*"))


@pytest.mark.parametrize("name", ["char(0)", "printf('%.*c', 300, 'x')"])
def test_a_text_that_postgresql_does_not_take_is_refused(
    kept: Path, tmp_path: Path, postgres: Cluster, name: str
) -> None:
    hostile = changed(kept, lambda connection: connection.execute(f"UPDATE clip SET name = {name}"))
    url, folder = postgres.new_database(), tmp_path / "new"
    with pytest.raises(OsgError, match="the database in the backup holds values") as refused:
        restore_backup(hostile, folder, url=url)
    assert "\n" not in str(refused.value)
    assert not (folder / "clips").exists()
    assert restore_backup(kept, folder, url=url) == 1


def test_what_a_killed_restore_has_left_is_removed(kept: Path, tmp_path: Path) -> None:
    folder = tmp_path / "new"
    (folder / ".restoring-killed").mkdir(parents=True)
    (folder / ".restoring-killed" / DATABASE).write_text("all rows")
    assert restore_backup(kept, folder) == 1
    assert sorted(path.name for path in folder.iterdir()) == ["clips", DATABASE]


def test_files_without_a_clip_are_refused(kept: Path, tmp_path: Path) -> None:
    statement = "DELETE FROM job; DELETE FROM clip"
    hostile = changed(kept, lambda connection: connection.executescript(statement))
    with pytest.raises(OsgError, match="holds files of a clip"):
        restore_backup(hostile, tmp_path / "new")


def test_a_compressed_backup_is_refused(kept: Path, tmp_path: Path) -> None:
    packed = tmp_path / "packed.zip"
    with (
        zipfile.ZipFile(kept) as archive,
        zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as written,
    ):
        for name in archive.namelist():
            written.writestr(name, archive.read(name))
    with pytest.raises(OsgError, match="is compressed"):
        restore_backup(packed, tmp_path / "new")


def test_a_manifest_of_a_thousand_brackets_is_refused(kept: Path, tmp_path: Path) -> None:
    deep = tmp_path / "deep.zip"
    with zipfile.ZipFile(deep, "w") as written:
        written.writestr("manifest.json", "[" * 100_000)
    with pytest.raises(OsgError, match="is no backup"):
        restore_backup(deep, tmp_path / "new")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such modes")
def test_a_backup_is_readable_by_its_owner_alone(
    kept: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[int] = []
    opened = zipfile.ZipFile.writestr

    def look(archive: zipfile.ZipFile, *given: object) -> None:
        (partial,) = tmp_path.glob("again.zip*")
        seen.append(stat.S_IMODE(partial.stat().st_mode))
        opened(archive, *given)  # type: ignore[arg-type]

    before = os.umask(0)
    try:
        monkeypatch.setattr(zipfile.ZipFile, "writestr", look)
        (tmp_path / "again.zip.part").touch(0o666)
        write_backup(tmp_path / "data", tmp_path / "again.zip")
    finally:
        os.umask(before)
    assert seen == [0o600]
    assert stat.S_IMODE((tmp_path / "again.zip").stat().st_mode) == 0o600


ROWS = {
    "clip": {
        "id": CLIP_ID,
        "name": "dive.mp4",
        "media_type": "video/mp4",
        "size": 5,
        "width": 64,
        "height": 48,
        "created": MOMENT,
    },
    "language": {"id": LANGUAGE_ID, "head": 1, "sample": 0, "created": MOMENT},
    "language_revision": {
        "language_id": LANGUAGE_ID,
        "revision": 1,
        "name": "pool",
        "labels": "[]",
        "change": "made",
        "document": '{"author": "Ada"}',
        "created": MOMENT,
    },
    "job": {
        "id": new_id(),
        "clip_id": CLIP_ID,
        "client": "diver",
        "status": "done",
        "attempts": 1,
        "warnings": "[]",
        "created": MOMENT,
    },
}


@pytest.mark.parametrize("revision", ["0005", "0011", "0016"])
def test_a_backup_of_an_earlier_version_is_restored(tmp_path: Path, revision: str) -> None:
    old, target = tmp_path / "old.db", tmp_path / "old.zip"
    with closing(Database(f"sqlite:///{old}")) as database:
        database.migrate(revision)
    with closing(sqlite3.connect(old)) as connection:
        for table, row in ROWS.items():
            names, places = ", ".join(row), ", ".join("?" * len(row))
            connection.execute(
                f"INSERT INTO {table} ({names}) VALUES ({places})", list(row.values())
            )
        connection.commit()
        connection.execute("PRAGMA journal_mode=DELETE")
    files = {DATABASE: old.read_bytes(), f"clips/{CLIP_ID}/video": b"video"}
    with zipfile.ZipFile(target, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
        digests = {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}
        manifest = {"format": "osg-studio/backup", "version": 1, "files": digests}
        archive.writestr("manifest.json", json.dumps(manifest))
    folder = tmp_path / "new"
    assert restore_backup(target, folder) == 1
    with closing(Database(f"sqlite:///{folder / DATABASE}")) as database:
        database.migrate()
        clips = ClipStore(database, folder / "clips")
        assert clips.get(CLIP_ID).clip.name == "dive.mp4"
        assert clips.video(CLIP_ID).read_bytes() == b"video"
        assert LanguageStore(database).get(LANGUAGE_ID).revision.name == "pool"


def test_a_clip_that_was_deleted_comes_back_deleted(tmp_path: Path) -> None:
    folder, target = tmp_path / "data", tmp_path / "kept.zip"
    with closing(Database(f"sqlite:///{folder / DATABASE}")) as database:
        database.migrate()
        clips = ClipStore(database, folder / "clips")
        clips.delete(add_clip(clips).clip.id)
    write_backup(folder, target)
    restore_backup(target, tmp_path / "new")
    with closing(Database(f"sqlite:///{tmp_path / 'new' / DATABASE}")) as database:
        with database.reading() as session:
            (clip,) = session.exec(select(Clip)).all()
        assert clip.deleted is not None


def _value(column: Column[Any], name: str) -> SearchStrategy[Any]:
    """Return values that this program may write into a column; ids are `name`."""
    place = f"{column.table.name}.{column.name}"
    known: dict[str, SearchStrategy[Any]] = {
        "clip.source": st.sampled_from([source.name for source in SOURCES]),
        "clip.media_type": st.sampled_from(["video/mp4", "video/webm", "video/mp2t"]),
        "clip.topics": st.just([]),
        "clip.options": st.sampled_from([None, {"turn": 90}]),
        "job.warnings": st.sampled_from([[], ["dark"]]),
        "job.salute_warnings": st.just([]),
        "job.status": st.sampled_from(list(JobStatus)),
        "language_revision.labels": st.just(["circle"]),
        "language_revision.document": st.just("{}"),
        "recognition.result": st.just("{}"),
        "labelled_take.former": st.sampled_from([None, ["0" * 64]]),
        "labelled_result.pair": st.sampled_from([None, ["circle", 'a "line"']]),
        "practice_take.pair": st.sampled_from([None, ["circle", "line"]]),
        "invited_take.status": st.sampled_from(get_args(TakeStatus)),
        "invitation.expires": st.integers(0, LONGEST_DAYS).map(lambda days: _at(days)),
    }
    if place in known:
        return known[place]
    if column.foreign_keys:
        return st.just(name)
    match column.type:
        case UtcDateTime():
            return st.integers(-1000, 0).map(_at)
        case Boolean():
            return st.booleans()
        case Float():
            return st.floats(0, 1e5)
        case Integer():
            return st.integers(1, 2**31 - 1)
        case String(length=32) | AutoString(length=32) if column.name.endswith("id"):
            return st.just(name)
        case String(length=length) | AutoString(length=length):
            letters = "abc \u00e4\u4e00'\"%\\"
            return st.text(letters, min_size=1, max_size=min(length or 80, 16))
        case _:
            raise AssertionError(f"{place} has a type that this test does not know")


def _at(days: int) -> datetime:
    return now().replace(microsecond=0) + timedelta(days=days)


# Without shrinking: an example takes a tenth of a second.
@settings(max_examples=10, phases=[Phase.explicit, Phase.generate], deadline=None)
@given(st.data())
def test_whatever_this_program_writes_comes_back_from_its_own_backup(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    folder = tmp_path_factory.mktemp("library")
    put_database(folder / DATABASE)
    written: dict[str, dict[str, Any]] = {}
    with closing(Database(f"sqlite:///{folder / DATABASE}")) as database:
        database.migrate()
        with database.writing() as session:
            for table in SQLModel.metadata.sorted_tables:
                row = {
                    column.name: data.draw(_value(column, "1" * 32), label=str(column))
                    for column in table.columns
                    if column.computed is None
                }
                session.connection().execute(delete(table))
                session.connection().execute(insert(table), [row])
                written[table.name] = row
    files = folder / "clips" / ("1" * 32)
    files.mkdir(parents=True)
    for name in {"recording.npz", *UPRIGHT.values(), *(each.name for each in SOURCES)}:
        (files / name).write_bytes(b"kept")
    assert write_backup(folder, folder / "kept.zip") == 1
    assert restore_backup(folder / "kept.zip", folder / "new") == 1
    with (
        closing(Database(f"sqlite:///{folder / 'new' / DATABASE}")) as database,
        database.reading() as session,
    ):
        for table in SQLModel.metadata.sorted_tables:
            rows = [dict(row) for row in session.connection().execute(table.select()).mappings()]
            if table.name == "invitation":
                assert rows[0]["withdrawn"] is not None
                written[table.name]["withdrawn"] = rows[0]["withdrawn"]
            if table.name not in {each.__tablename__ for each in OF_A_SERVER}:
                assert rows == [written[table.name]]


def test_a_planted_invitation_lets_nobody_in(kept: Path, tmp_path: Path) -> None:
    def change(connection: sqlite3.Connection) -> None:
        connection.execute(
            "INSERT INTO language (id, head, sample, created) VALUES (?, 1, 0, ?)",
            (LANGUAGE_ID, MOMENT),
        )
        connection.execute(
            "INSERT INTO invitation (id, language_id, sha256, owner, most_takes, most_bytes, takes,"
            " bytes, created, expires) VALUES (?, ?, ?, '', 9, 9, 0, 0, ?, ?)",
            (CLIP_ID, LANGUAGE_ID, digest("planted"), MOMENT, f"{now() + timedelta(days=7):%F %T}"),
        )

    restore_backup(changed(kept, change), tmp_path / "new")
    with closing(Database(f"sqlite:///{tmp_path / 'new' / DATABASE}")) as database:
        found = InvitationStore(database).find(digest("planted"))
    assert found is not None
    assert found.closed == "withdrawn"
