"""The migrations make from nothing exactly the tables that the models describe."""

import sqlite3
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.migration import MigrationContext
from sqlalchemy import inspect
from sqlmodel import SQLModel

from app.api.jobs.extraction_queue import options_of
from app.clip_sources import ReadOptions
from app.recognition import Language
from app.store import ClipStore, Database, LanguageStore, RecognitionStore, TakeStore
from app.store.database import MIGRATIONS


def test_an_empty_file_gets_the_tables_of_the_models(database: Database) -> None:
    with database.engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, SQLModel.metadata) == []


def test_migrating_again_changes_nothing(database: Database) -> None:
    before = set(inspect(database.engine).get_table_names())
    database.migrate()
    assert set(inspect(database.engine).get_table_names()) == before


@pytest.mark.withstands(row="H21")
def test_a_migration_that_breaks_off_leaves_the_database_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    database = Database(f"sqlite:///{tmp_path / 'studio.db'}")
    upgrade = command.upgrade

    def broken_upgrade(config: Config, revision: str) -> None:
        upgrade(config, revision)
        raise KeyboardInterrupt

    monkeypatch.setattr("app.store.database.command.upgrade", broken_upgrade)
    with pytest.raises(KeyboardInterrupt):
        database.migrate()
    assert inspect(database.engine).get_table_names() == []
    monkeypatch.undo()
    database.migrate()
    assert "clip" in inspect(database.engine).get_table_names()


def test_older_clips_get_the_source_that_they_came_as(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'studio.db'}")
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    read_as = '{"ending": ".csv", "frame_rate": 25.0, "frame_size": null}'
    topics = '[{"name": "/left"}]'
    rows = {"video": ("[]", None), "bag": (topics, None), "keypoints": ("[]", read_as)}
    with database.engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, "0005")
        for name, (listed, keypoints) in rows.items():
            connection.exec_driver_sql(
                "INSERT INTO clip (id, name, media_type, size, width, height, topics, keypoints, "
                "created) VALUES (?, 'dive', 'video/mp4', 1, 64, 48, ?, ?, '2026-01-01 00:00:00')",
                (name, listed, keypoints),
            )
            connection.exec_driver_sql(
                "INSERT INTO job (id, clip_id, client, status, attempts, warnings, created) "
                "VALUES (?, ?, 'local', 'done', 1, '[]', '2026-01-01 00:00:00')",
                (f"job of {name}", name),
            )
    database.migrate()
    clips = {each.clip.id: each for each in ClipStore(database, tmp_path / "clips").all()}
    assert {name: each.clip.source for name, each in clips.items()} == {name: name for name in rows}
    assert {name: each.job.id for name, each in clips.items()} == {
        name: f"job of {name}" for name in rows
    }
    assert all(each.clip.job_id == each.job.id for each in clips.values())
    options = options_of(clips["keypoints"].clip)
    assert (options.ending, options.frame_rate, options.frame_size) == (".csv", 25.0, None)
    assert options_of(clips["video"].clip) == ReadOptions()


@pytest.mark.parametrize("version", ["0.1.0", "0.2.0", "0.3.0"])
def test_a_database_of_a_former_version_keeps_all_that_is_in_it(
    tmp_path: Path, version: str
) -> None:
    script = (Path(__file__).parent / "schemas" / f"{version}.sql").read_text("utf-8")
    with closing(sqlite3.connect(tmp_path / "studio.db")) as former:
        former.executescript(script)
    database = Database(f"sqlite:///{tmp_path / 'studio.db'}")
    database.migrate()
    with database.engine.connect() as connection:
        assert connection.exec_driver_sql("PRAGMA foreign_key_check").all() == []
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, SQLModel.metadata) == []
    clips = ClipStore(database, tmp_path / "clips")
    (kept,) = clips.all()
    assert (kept.clip.name, kept.clip.size, kept.clip.duration) == ("dive 'one'.mp4", 1234, 2.5)
    assert kept.clip.created == datetime(2026, 1, 2, 3, 4, 5, 678901, UTC)
    assert (kept.clip.source, kept.clip.owner, kept.clip.idempotency_key) == ("video", "", "key-1")
    assert (kept.job.status, kept.job.frames, kept.job.warnings) == ("done", 50, ["a warning"])
    clips.restore("d" * 32)
    restored = clips.get("d" * 32)
    assert (restored.clip.duration, restored.job.error_code) == (None, "decoder")
    languages = LanguageStore(database)
    state = languages.get("a" * 32)
    assert (state.revision.revision, state.revision.author) == (2, "Ada")
    assert Language.from_json(state.revision.document).name == "pool"
    assert [each.change for each in languages.revisions("a" * 32)] == ["Renamed", "Created"]
    (recognised,) = RecognitionStore(database).all(limit=10)
    assert (recognised.clip_id, recognised.start, recognised.expected) == ("c" * 32, 0.5, "circle")
    assert languages.seeded() == {"osg-table"}
    (take,) = TakeStore(database).tested("a" * 32)
    assert (take.take.start, take.take.expected) == (0.5, "circle")
