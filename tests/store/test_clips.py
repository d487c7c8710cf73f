"""Clips: file and row appear and disappear together, whatever breaks in between."""

import errno
import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import event
from sqlmodel import Session

from app.store import (
    Clip,
    ClipStore,
    ClipWithJob,
    Database,
    JobStatus,
    JobStore,
    NotFound,
    StoreUnavailable,
)
from app.store.clips import TOPIC_NEEDED
from app.store.models import now
from tests.store.conftest import add_clip


def test_a_clip_has_its_bytes_and_a_waiting_job(clips: ClipStore) -> None:
    added = add_clip(clips)
    found = clips.get(added.clip.id)
    assert clips.video(found.clip.id).read_bytes() == b"video"
    assert found.clip.name == "dive.mp4"
    assert found.job.status == JobStatus.QUEUED
    assert found.clip.created.tzinfo is not None


def test_clips_are_listed_newest_first(clips: ClipStore) -> None:
    first, second = add_clip(clips), add_clip(clips)
    assert [found.clip.id for found in clips.all()] == [second.clip.id, first.clip.id]


def test_a_clip_shows_its_newest_job(clips: ClipStore, jobs: JobStore) -> None:
    added = add_clip(clips)
    jobs.finish(added.job.id, JobStatus.FAILED, code="decoder", error="broke")
    retried = jobs.retry(added.clip.id, "diver")
    assert retried is not None
    assert clips.get(added.clip.id).job.id == retried.id


TOPICS = [
    {"name": "/left", "messages": 10, "width": 64, "height": 48, "duration": 1.5},
    {"name": "/right", "messages": 20, "width": 128, "height": 96, "duration": 3.0},
]


def add_bag(clips: ClipStore, topic: str | None = None) -> ClipWithJob:
    """Store a dive recording with two topics."""
    partial = clips.new_partial()
    partial.write_bytes(b"bag")
    clip = Clip(
        name="dive.mcap",
        media_type="video/mp4",
        size=3,
        width=64,
        height=48,
        topics=TOPICS,
        topic=topic,
        source="bag",
    )
    return clips.add(clip, partial, "diver")


def test_a_dive_recording_waits_for_its_topic(clips: ClipStore, jobs: JobStore) -> None:
    added = add_bag(clips)
    assert (added.job.status, added.job.error_code) == (JobStatus.FAILED, TOPIC_NEEDED)
    assert clips.received(added.clip).read_bytes() == b"bag"
    assert not clips.video(added.clip.id).exists()
    with pytest.raises(NotFound, match="no topic '/middle'"):
        clips.choose_topic(added.clip.id, "/middle")
    clips.choose_topic(added.clip.id, "/right")
    chosen = clips.get(added.clip.id).clip
    assert (chosen.topic, chosen.needs_topic) == ("/right", False)
    assert (chosen.width, chosen.height, chosen.frames, chosen.duration) == (128, 96, 20, 3.0)
    assert jobs.retry(added.clip.id, "diver") is not None
    assert clips.sweep(now()) == 0


def test_a_dive_recording_whose_topic_is_known_is_queued(clips: ClipStore) -> None:
    assert add_bag(clips, "/left").job.status == JobStatus.QUEUED


def test_a_file_whose_row_cannot_be_written_is_where_it_was(clips: ClipStore) -> None:
    first = add_clip(clips)
    partial = clips.new_partial()
    partial.write_bytes(b"other")
    taken = Clip(**first.clip.model_dump(exclude={"id"}), id="b" * 32)
    taken.name = None  # type: ignore[assignment]
    with pytest.raises(Exception, match=r"(?i)not.null"):
        clips.add(taken, partial, "diver")
    assert {path.name for path in clips.folder.iterdir()} == {first.clip.id, partial.name}
    assert partial.read_bytes() == b"other"  # It can be added again.


class LosesAnswers(Database):
    """Loses the connection after each commit, as a database does that is restarted then."""

    @contextmanager
    def writing(self, *, counted: bool = True) -> Iterator[Session]:
        with super().writing(counted=counted) as session:
            yield session
        raise StoreUnavailable("the connection was lost; nothing is known of the last change")


@pytest.mark.withstands(row="H31")
def test_a_clip_whose_commit_was_not_answered_keeps_its_file(
    database: Database, tmp_path: Path
) -> None:
    lossy = LosesAnswers(database.engine.url.render_as_string(hide_password=False))
    clip_id = add_clip(ClipStore(lossy, tmp_path / "clips"), key="same").clip.id
    clips = ClipStore(database, tmp_path / "clips")
    assert clips.video(clip_id).read_bytes() == b"video"
    assert add_clip(clips, key="same").clip.id == clip_id
    lossy.close()


def test_a_clip_is_copied_where_a_file_has_one_name(
    clips: ClipStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EXDEV, "another file system")

    monkeypatch.setattr(os, "link", refuse)
    added = add_clip(clips)
    assert clips.video(added.clip.id).read_bytes() == b"video"
    assert [path.name for path in clips.folder.iterdir()] == [added.clip.id]


def test_a_list_needs_no_value_for_each_clip(sqlite: Database, tmp_path: Path) -> None:
    @event.listens_for(sqlite.engine, "checkout")
    def limit(connection: sqlite3.Connection, *_: object) -> None:
        connection.setlimit(sqlite3.SQLITE_LIMIT_VARIABLE_NUMBER, 25)

    clips = ClipStore(sqlite, tmp_path / "clips")
    added = {add_clip(clips).clip.id for _ in range(30)}
    assert {each.clip.id for each in clips.all()} == added


def test_the_second_of_two_racing_uploads_gets_the_first_ones_clip(clips: ClipStore) -> None:
    first = add_clip(clips, key="same")
    second = add_clip(clips, key="same")
    assert second.clip.id == first.clip.id
    assert len(clips.all()) == 1
    folders = [path.name for path in clips.folder.iterdir() if path.is_dir()]
    assert folders == [first.clip.id]


def test_a_deleted_clip_is_gone_until_it_is_restored(clips: ClipStore) -> None:
    clip_id = add_clip(clips).clip.id
    clips.delete(clip_id)
    assert clips.all() == []
    for use in (clips.get, clips.delete):
        with pytest.raises(NotFound):
            use(clip_id)
    clips.restore(clip_id)
    assert clips.get(clip_id).clip.id == clip_id
    assert clips.video(clip_id).read_bytes() == b"video"


def test_only_what_was_deleted_long_ago_is_purged(clips: ClipStore) -> None:
    kept, fresh, old = add_clip(clips), add_clip(clips), add_clip(clips)
    clips.delete(old.clip.id)
    between = now()
    clips.delete(fresh.clip.id)
    assert clips.purge(between) == 1
    assert not clips.video(old.clip.id).exists()
    with pytest.raises(NotFound):
        clips.restore(old.clip.id)
    clips.restore(fresh.clip.id)
    assert len(clips.all()) == 2
    assert clips.purge(now() + timedelta(days=1)) == 0
    assert clips.video(kept.clip.id).exists()


@pytest.mark.withstands(row="H21")
def test_sweeping_removes_what_crashes_left_and_nothing_else(
    clips: ClipStore, tmp_path: Path
) -> None:
    clip_id = add_clip(clips).clip.id
    clips.recording(clip_id).write_bytes(b"recording")
    clips.poster(clip_id).write_bytes(b"poster")
    clips.new_partial().write_bytes(b"half an upl")
    (clips.video(clip_id).parent / ".recording.npz.k3j2").write_bytes(b"half a record")
    nameless = clips.folder / ("f" * 32)
    nameless.mkdir()
    (nameless / "video").write_bytes(b"renamed, but its row was never written")
    assert clips.sweep(now() - timedelta(days=1)) == 0  # Another server may be writing them.
    assert clips.sweep(now()) == 3
    left = sorted(path.name for path in clips.folder.rglob("*"))
    assert left == sorted([clip_id, "video", "recording.npz", "poster.jpg"])
    assert clips.sweep(now()) == 0


def test_purging_a_clip_takes_its_jobs_along(
    clips: ClipStore, jobs: JobStore, database: Database
) -> None:
    added = add_clip(clips)
    clips.delete(added.clip.id)
    clips.purge(now())
    assert jobs.resume() == []
    with pytest.raises(NotFound):
        jobs.get(added.job.id)


def test_turned_pictures_have_a_video_of_their_own_and_turns_add_up(
    clips: ClipStore, jobs: JobStore
) -> None:
    added = add_clip(clips)
    clip_id = added.clip.id
    assert jobs.start(added.job.id)
    jobs.complete(added.job.id, 12, ())
    assert jobs.retry(clip_id, "diver") is None
    assert jobs.retry(clip_id, "diver", anew=True) is not None
    assert jobs.retry(clip_id, "diver", anew=True) is None  # It waits already.
    clips.turn(clip_id, 90)
    clip = clips.get(clip_id).clip
    assert (clip.turn, clip.width, clip.height, clip.video_is_made) == (90, 48, 64, True)
    assert clips.video(clip_id) != clips.received(clip)
    clips.video(clip_id).write_bytes(b"turned")
    assert clips.sweep(now()) == 0
    clips.turn(clip_id, 180)
    assert (clips.get(clip_id).clip.turn, clips.get(clip_id).clip.width) == (270, 48)
    clips.turn(clip_id, 90)
    clip = clips.get(clip_id).clip
    assert (clip.turn, clip.width, clip.height, clip.video_is_made) == (0, 64, 48, False)
    assert clips.video(clip_id).read_bytes() == b"video"
    with pytest.raises(NotFound):
        clips.turn("none", 90)
