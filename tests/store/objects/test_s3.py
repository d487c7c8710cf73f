"""Clips in S3: kept before the database says so, fetched once, gone with their row."""

from __future__ import annotations

import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from pathlib import Path
from threading import Barrier

import pytest

from app.store import Clip, ClipStore, Database, StoreUnavailable
from app.store.clips import RECORDING
from app.store.models import now
from app.store.objects import ObjectStore, open_object_store
from tests.s3 import BUCKET, S3Server
from tests.store.conftest import add_clip

Servers = tuple[ClipStore, ClipStore]


@pytest.fixture
def objects(s3: S3Server) -> ObjectStore:
    return open_object_store(f"s3://{BUCKET}/pool/")


@pytest.fixture
def servers(database: Database, tmp_path: Path, objects: ObjectStore) -> Servers:
    """Return the clips as two servers see them, each with a folder of its own."""
    one, two = (ClipStore(database, tmp_path / name, objects) for name in ("one", "two"))
    return one, two


def test_a_clip_and_what_is_found_in_it_are_read_by_another_server(
    servers: Servers, s3: S3Server
) -> None:
    one, two = servers
    clip = add_clip(one).clip
    assert s3.names() == {f"pool/{clip.id}/video"}
    assert two.video(clip.id).read_bytes() == b"video"
    assert not two.recording(clip.id).exists()
    one.place(clip.id, RECORDING).write_bytes(b"found")
    one.keep_found(clip)
    assert two.recording(clip.id).read_bytes() == b"found"
    assert not two.poster(clip.id).exists()
    assert s3.names() == {f"pool/{clip.id}/video", f"pool/{clip.id}/recording.npz"}
    assert {path.name for path in two.folder.glob("*/*")} == {"video", "recording.npz"}


def test_requests_at_the_same_time_fetch_a_file_once(
    database: Database, tmp_path: Path, objects: ObjectStore
) -> None:
    clip = add_clip(ClipStore(database, tmp_path / "one", objects)).clip
    fetched: list[str] = []

    class Counting:
        upload, remove, size = objects.upload, objects.remove, objects.size

        def download(self, name: str, target: Path) -> bool:
            fetched.append(name)
            return objects.download(name, target)

    store, together = ClipStore(database, tmp_path / "two", Counting()), Barrier(8)

    def read(_: int) -> bytes:
        together.wait()
        return store.video(clip.id).read_bytes()

    with ThreadPoolExecutor(8) as pool:
        assert set(pool.map(read, range(8))) == {b"video"}
    assert fetched == [f"{clip.id}/video"]


def test_nothing_is_lost_while_the_object_store_is_away(servers: Servers, s3: S3Server) -> None:
    one, two = servers
    kept = add_clip(one).clip
    s3.stop()
    partial = one.new_partial()
    partial.write_bytes(b"video")
    clip = Clip(name="dive.mp4", media_type="video/mp4", size=5, width=64, height=48)
    with pytest.raises(StoreUnavailable, match="s3://dives"):
        one.add(clip, partial, "diver")
    assert partial.read_bytes() == b"video"
    with pytest.raises(StoreUnavailable):
        two.video(kept.id)
    assert one.video(kept.id).read_bytes() == b"video"
    assert not list(two.folder.glob("*/*"))
    s3.start()
    added = one.add(clip.model_copy(), partial, "diver").clip
    assert two.video(added.id).read_bytes() == two.video(kept.id).read_bytes() == b"video"


def test_a_purged_clip_leaves_no_object(
    servers: Servers, s3: S3Server, caplog: pytest.LogCaptureFixture
) -> None:
    one, two = servers
    first, second = add_clip(one).clip, add_clip(one).clip
    one.delete(first.id)
    # By a server that has no file of it.
    assert two.purge(now() + timedelta(1)) == 1
    assert s3.names() == {f"pool/{second.id}/video"}
    one.delete(second.id)
    s3.stop()
    assert two.purge(now() + timedelta(1)) == 1
    assert "at a later start" in caplog.text
    assert two.sweep(now() + timedelta(1)) == 0
    s3.start()
    assert s3.names() == {f"pool/{second.id}/video"}
    assert two.sweep(now() + timedelta(1)) == 1
    assert s3.names() == set()
    assert one.sweep(now() + timedelta(1)) == 2
    assert not list(one.folder.iterdir())


KILLED = """
import os, signal, sys
from pathlib import Path
from app.store import Clip, ClipStore, Database
from app.store.objects import open_object_store

objects = open_object_store("s3://dives/pool")

class Killed:
    def upload(self, file, name):
        objects.upload(file, name)
        os.kill(os.getpid(), signal.SIGKILL)

store = ClipStore(Database(sys.argv[1]), Path(sys.argv[2]), Killed())
partial = store.new_partial()
partial.write_bytes(b"video")
clip = Clip(name="dive.mp4", media_type="video/mp4", size=5, width=64, height=48)
store.add(clip, partial, "diver")
"""


@pytest.mark.withstands(row="H31")
@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="has no SIGKILL")
def test_what_a_kill_between_upload_and_database_left_goes_at_the_next_start(
    sqlite: Database, tmp_path: Path, s3: S3Server, objects: ObjectStore
) -> None:
    url, folder = sqlite.engine.url.render_as_string(), tmp_path / "clips"
    ended = subprocess.run([sys.executable, "-c", KILLED, url, str(folder)], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert len(s3.names()) == 1
    store = ClipStore(sqlite, folder, objects)
    assert store.all() == []
    assert [path.read_bytes() for path in folder.glob("*.part")] == [b"video"]
    assert store.sweep(now()) == 2
    assert s3.names() == set()
    assert not list(folder.iterdir())


def test_a_wrong_key_and_a_missing_bucket_are_named(
    s3: S3Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "video"
    file.write_bytes(b"video")
    with pytest.raises(StoreUnavailable, match=r"NoSuchBucket.*look at AWS_ENDPOINT_URL"):
        open_object_store("s3://elsewhere").upload(file, "a/video")
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.delenv(name)
    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", str(tmp_path / "none"))
    with pytest.raises(StoreUnavailable, match="credentials"):
        open_object_store(f"s3://{BUCKET}").upload(file, "a/video")
