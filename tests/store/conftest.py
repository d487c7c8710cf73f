"""A real store: SQLite on disk, migrated, in a folder of the test's own."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from app.store import Clip, ClipStore, ClipWithJob, Database, JobStore, LanguageStore


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    database = Database(f"sqlite:///{tmp_path / 'studio.db'}")
    database.migrate()
    yield database
    database.close()


@pytest.fixture
def clips(database: Database, tmp_path: Path) -> ClipStore:
    return ClipStore(database, tmp_path / "clips")


@pytest.fixture
def jobs(database: Database) -> JobStore:
    return JobStore(database)


@pytest.fixture
def languages(database: Database) -> LanguageStore:
    return LanguageStore(database)


def add_clip(
    clips: ClipStore, *, name: str = "dive.mp4", client: str = "diver", key: str | None = None
) -> ClipWithJob:
    """Store a clip of five bytes."""
    partial = clips.new_partial()
    partial.write_bytes(b"video")
    clip = Clip(
        name=name,
        media_type="video/mp4",
        size=5,
        width=64,
        height=48,
        duration=1.5,
        idempotency_key=key,
    )
    return clips.add(clip, partial, client)
