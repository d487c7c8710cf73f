"""Tests of the store of unfinished uploads."""

from __future__ import annotations

import os
from datetime import timedelta
from pathlib import Path

import pytest

from app.store import UploadStore
from app.store.models import now

DAY = timedelta(days=1)


@pytest.fixture
def store(tmp_path: Path) -> UploadStore:
    return UploadStore(tmp_path)


def grow_old(path: Path) -> None:
    long_ago = (now() - 3 * DAY).timestamp()
    os.utime(path, (long_ago, long_ago))


def left_over(folder: Path, upload_id: str) -> Path:
    """Return a description that a crash left half written."""
    partial = folder / f".{upload_id}.json.0123abcd.part"
    partial.write_bytes(b"{")
    return partial


def test_what_nobody_goes_on_with_is_removed_after_a_while(
    store: UploadStore, tmp_path: Path
) -> None:
    old, fresh = store.create("old.mp4", 3), store.create("fresh.mp4", 3)
    for path in tmp_path.glob(f"{old.id}*"):
        grow_old(path)
    assert store.purge(now() - DAY) == 1
    assert {path.stem for path in tmp_path.iterdir()} == {fresh.id}


def test_an_old_part_of_no_upload_is_removed_once(store: UploadStore, tmp_path: Path) -> None:
    grow_old(left_over(tmp_path, "0" * 32))
    writing = left_over(tmp_path, "1" * 32)
    assert store.purge(now() - DAY) == 1
    assert list(tmp_path.iterdir()) == [writing]
    assert store.purge(now() - DAY) == 0


def test_what_an_upload_that_goes_on_has_stays(store: UploadStore, tmp_path: Path) -> None:
    upload = store.create("slow.mp4", 3)
    part = left_over(tmp_path, upload.id)
    grow_old(part)
    grow_old(tmp_path / f"{upload.id}.json")
    assert store.purge(now() - DAY) == 0
    assert part.exists()
    assert store.get(upload.id) == upload
    store.remove(upload.id)
    assert store.purge(now() - DAY) == 1
    assert not list(tmp_path.iterdir())
