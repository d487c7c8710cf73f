"""A real store: SQLite on disk and PostgreSQL, migrated, each test with one of its own."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from app.store import Clip, ClipStore, ClipWithJob, Database, JobStore, LanguageStore
from tests.postgres import Cluster
from tests.store.new_database import put_database


@pytest.fixture(params=["sqlite", "postgresql"])
def database_url(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """Return the URL of an empty database; a test that uses it runs once for each kind."""
    if request.param == "sqlite":
        return f"sqlite:///{tmp_path / 'studio.db'}"
    cluster: Cluster = request.getfixturevalue("postgres")
    return cluster.new_database()


@pytest.fixture
def database(database_url: str, tmp_path: Path) -> Iterator[Database]:
    if database_url.startswith("sqlite"):
        put_database(tmp_path / "studio.db")
    database = Database(database_url)
    database.migrate()
    yield database
    database.close()


@pytest.fixture
def sqlite(tmp_path: Path) -> Iterator[Database]:
    """Return a database in a file, where it is the file that is looked at."""
    put_database(tmp_path / "studio.db")
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
    clips: ClipStore,
    *,
    name: str = "dive.mp4",
    client: str = "diver",
    key: str | None = None,
    upload_id: str | None = None,
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
    return clips.add(clip, partial, client, upload_id=upload_id)
