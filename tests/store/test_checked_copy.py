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
from pathlib import Path

import pytest
from sqlmodel import select

from app.recognition.errors import OsgError
from app.store import Clip, ClipStore, Database, LanguageStore
from app.store.backup import DATABASE, restore_backup, write_backup
from app.store.models import new_id
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


@pytest.mark.parametrize("revision", ["0001", "0004", "0007", "0009", "0010"])
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
