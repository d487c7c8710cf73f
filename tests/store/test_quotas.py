"""Quotas: uploads under way count, for as long as bytes come, on whichever server."""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import pytest

from app.store import (
    NO_QUOTA,
    Clip,
    ClipStore,
    Database,
    LanguageStore,
    Quota,
    QuotaExceeded,
    QuotaStore,
    UploadStore,
    Usage,
)
from app.store.languages import Draft
from tests.store.conftest import add_clip


@pytest.fixture
def uploads(tmp_path: Path) -> UploadStore:
    return UploadStore(tmp_path / "uploads")


@pytest.fixture
def quotas(database: Database) -> QuotaStore:
    return QuotaStore(database)


def test_an_upload_counts_until_it_is_released(uploads: UploadStore, quotas: QuotaStore) -> None:
    begun = uploads.create("dive.mp4", 7, owner="Jo")
    quotas.reserve(begun, Quota("Jo", clips=1))
    quotas.reserve(uploads.create("dive.mp4", 5, owner="Bo"), NO_QUOTA)
    quotas.renew(begun)
    assert quotas.usage("Jo") == Usage(1, 7)
    quotas.release(begun.id)
    quotas.release(begun.id)
    assert quotas.usage("Jo") == Usage(0, 0)


def test_what_is_refused_reserves_nothing(uploads: UploadStore, quotas: QuotaStore) -> None:
    with pytest.raises(QuotaExceeded, match=r"0\.0 MB in all; send something shorter"):
        quotas.reserve(uploads.create("dive.mp4", 7, owner="Jo"), Quota("Jo", bytes=6))
    assert quotas.usage("Jo") == Usage(0, 0)


def test_an_upload_without_bytes_lapses_and_counts_again_when_it_goes_on(
    uploads: UploadStore, quotas: QuotaStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun = uploads.create("dive.mp4", 7, owner="Jo")
    quotas.reserve(begun, NO_QUOTA)
    with monkeypatch.context() as later:
        later.setattr("app.store.quotas.KEPT", timedelta(seconds=-5))
        later.setattr("app.store.quotas.RENEWED", timedelta(seconds=-5))
        assert quotas.usage("Jo") == Usage(0, 0)
        # Another one that begins clears it away.
        quotas.reserve(uploads.create("dive.mp4", 1, owner="Bo"), NO_QUOTA)
    assert quotas.usage("Jo") == Usage(0, 0)
    quotas.renew(begun)
    assert quotas.usage("Jo") == Usage(1, 7)


def test_an_upload_becomes_its_clip(
    clips: ClipStore, uploads: UploadStore, quotas: QuotaStore
) -> None:
    begun = uploads.create("dive.mp4", 5, owner="")
    quotas.reserve(begun, NO_QUOTA)
    add_clip(clips, key=begun.id, upload_id=begun.id)
    assert quotas.usage("") == Usage(1, 5)


def test_a_clip_with_the_key_of_an_upload_under_way_releases_none_of_its_quota(
    clips: ClipStore, uploads: UploadStore, quotas: QuotaStore
) -> None:
    begun = uploads.create("dive.mp4", 7, owner="")
    quotas.reserve(begun, NO_QUOTA)
    add_clip(clips, key=begun.id)
    assert quotas.usage("") == Usage(2, 12)


@pytest.mark.withstands(row="H33")
def test_deleted_clips_count_until_they_are_purged(clips: ClipStore, quotas: QuotaStore) -> None:
    quota = Quota("Jo", clips=2)
    first, second = (add_owned(clips, quota) for _ in range(2))
    for clip_id in (first, second):
        clips.delete(clip_id)
    assert quotas.usage("Jo") == Usage(2, 10)
    assert quotas.usage("Jo", deleted=False) == Usage(0, 0)
    with pytest.raises(QuotaExceeded) as refused:
        add_owned(clips, quota)
    assert refused.value.deleted_suffice
    assert clips.purge_for("Jo", refused.value.excess) == Usage(0, 0)
    third = add_owned(clips, quota)
    assert {path.name for path in clips.folder.iterdir()} == {second, third}
    clips.restore(second)
    with pytest.raises(QuotaExceeded) as full:
        add_owned(clips, quota)
    assert not full.value.deleted_suffice


@pytest.mark.withstands(row="H33")
def test_each_revision_counts_with_its_document(
    languages: LanguageStore, quotas: QuotaStore
) -> None:
    quota = Quota("Jo", bytes=100)
    draft = Draft(name="pool", labels=[], change="made", document="é" * 20)
    made = languages.create(draft, quota=quota)
    languages.edit(made.record.id, lambda _head, _number: draft, quota=quota)
    assert quotas.usage("Jo") == Usage(0, 80)
    with pytest.raises(QuotaExceeded, match="delete clips or languages"):
        languages.edit(made.record.id, lambda _head, _number: draft, quota=quota)
    assert [row.revision for row in languages.revisions(made.record.id)] == [2, 1]
    languages.edit(made.record.id, lambda _head, _number: draft)  # by somebody else
    languages.delete(made.record.id)
    assert languages.purge_for("Jo", Usage(0, 1)) == Usage(0, 1)  # Not Jo's alone.
    assert quotas.usage("Jo", deleted=False) == Usage(0, 80)
    with pytest.raises(QuotaExceeded) as full:
        languages.create(replace(draft, document="x" * 50), quota=quota)
    assert not full.value.deleted_suffice  # So no clip is purged in vain.
    own = languages.create(Draft(name="own", labels=[], change="", document="x" * 20), quota=quota)
    languages.delete(own.record.id)
    assert languages.purge_for("Jo", Usage(0, 20)) == Usage(0, 0)
    assert quotas.usage("Jo") == Usage(0, 80)


def add_owned(clips: ClipStore, quota: Quota) -> str:
    """Store a clip of five bytes within a quota, and return its id."""
    partial = clips.new_partial()
    partial.write_bytes(b"video")
    clip = Clip(
        name="dive.mp4", media_type="video/mp4", size=5, width=64, height=48, owner=quota.owner
    )
    try:
        return clips.add(clip, partial, "diver", quota).clip.id
    finally:
        partial.unlink(missing_ok=True)
