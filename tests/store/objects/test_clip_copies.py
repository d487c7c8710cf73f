"""Copies of clips: bounded, but none in use or missing in the object store is deleted."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from time import time

import pytest

from app.store import ClipStore, Database, JobStatus, JobStore
from app.store.clips import POSTER
from app.store.objects import ObjectStore, open_object_store
from app.store.objects.clip_copies import RECENT_SECONDS
from tests.api.running import until
from tests.s3 import BUCKET, S3Server
from tests.store.conftest import add_clip

LIMIT = 12
"""Bytes: two clips of five."""

OLD = 2 * RECENT_SECONDS
"""Age of a use that keeps no copy."""

Add = Callable[[], str]


@pytest.fixture
def objects(s3: S3Server) -> ObjectStore:
    return open_object_store(f"s3://{BUCKET}/pool")


@pytest.fixture
def store(sqlite: Database, tmp_path: Path, objects: ObjectStore) -> ClipStore:
    """Return clips whose copies nothing bounds."""
    return ClipStore(sqlite, tmp_path / "clips", objects)


@pytest.fixture
def bounded(sqlite: Database, tmp_path: Path, objects: ObjectStore) -> ClipStore:
    """Return the same clips with a limit, which is applied when a test calls for it."""
    return ClipStore(sqlite, tmp_path / "clips", objects, LIMIT)


@pytest.fixture
def add(store: ClipStore, sqlite: Database) -> Add:
    """Return what adds a clip whose job has ended, and whose copy is older than those before."""

    def add() -> str:
        added = add_clip(store)
        JobStore(sqlite).finish(added.job.id, JobStatus.FAILED)
        age(store.place(added.clip.id, "video"), OLD + len(list(store.folder.iterdir())))
        return added.clip.id

    return add


def age(file: Path, seconds: float) -> None:
    os.utime(file, (time() - seconds, file.stat().st_mtime))


def copies(store: ClipStore) -> set[str]:
    return {path.parent.name for path in store.folder.glob("*/video")}


def test_the_copies_not_used_for_longest_go_and_are_fetched_again(
    store: ClipStore, bounded: ClipStore, add: Add
) -> None:
    newest, middle, oldest = add(), add(), add()
    assert bounded.video(oldest).read_bytes() == b"video"  # used now
    assert bounded.make_room() == 1
    assert copies(store) == {newest, oldest}
    assert store.video(middle).read_bytes() == b"video"
    assert bounded.make_room() == 1
    assert copies(store) == {middle, oldest}


def test_no_copy_goes_that_is_held_new_at_work_or_the_only_one(
    store: ClipStore, bounded: ClipStore, add: Add, sqlite: Database, s3: S3Server
) -> None:
    held, retried, alone, unsaid, read = (add() for _ in range(5))
    recent = add_clip(store).clip.id
    JobStore(sqlite).retry(retried, "diver")
    s3.client().delete_object(Bucket=BUCKET, Key=f"pool/{alone}/video")
    poster = store.place(unsaid, POSTER)
    poster.write_bytes(b"picture")  # what a job has written and not kept yet
    age(poster, OLD)
    received = store.new_partial()
    received.write_bytes(b"upload")
    with bounded.hold([store.place(held, "video")]), store.video(read).open("rb") as opened:
        assert bounded.make_room() == 2
        assert opened.read() == b"video"
    assert copies(store) == {held, retried, alone, recent}
    assert poster.exists()
    assert received.exists()
    assert bounded.make_room() == 0  # It was held until just now.
    age(store.place(held, "video"), OLD)
    assert bounded.make_room() == 1
    assert held not in copies(store)


def test_copies_stay_while_the_object_store_is_away(
    store: ClipStore, bounded: ClipStore, add: Add, s3: S3Server
) -> None:
    clips = {add() for _ in range(4)}
    s3.stop()
    assert bounded.make_room() == 0
    assert copies(store) == clips
    s3.start()
    assert bounded.make_room() == 2


def test_room_is_made_by_itself_when_copies_come(
    sqlite: Database, tmp_path: Path, objects: ObjectStore, add: Add
) -> None:
    clips = [add() for _ in range(3)]
    other = ClipStore(sqlite, tmp_path / "other", objects)
    for clip in clips[:2]:
        age(other.video(clip), OLD)
    ClipStore(sqlite, tmp_path / "other", objects, LIMIT).video(clips[2])
    until(lambda: len(copies(other)) == 2)
    assert clips[2] in copies(other)


def test_without_a_limit_and_in_a_shared_folder_nothing_goes(
    sqlite: Database, tmp_path: Path, store: ClipStore, add: Add
) -> None:
    clips = {add() for _ in range(4)}
    assert store.make_room() == 0
    assert ClipStore(sqlite, store.folder, most_copied=LIMIT).make_room() == 0
    assert copies(store) == clips
