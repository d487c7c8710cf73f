"""Quotas: uploads under way count, for as long as bytes come, on whichever server."""

from __future__ import annotations

from datetime import timedelta
from pathlib import Path

import pytest

from app.store import ClipStore, Database, QuotaStore, UploadStore, Usage
from tests.store.conftest import add_clip


@pytest.fixture
def uploads(tmp_path: Path) -> UploadStore:
    return UploadStore(tmp_path / "uploads")


@pytest.fixture
def quotas(database: Database) -> QuotaStore:
    return QuotaStore(database)


def test_an_upload_counts_until_it_is_released(uploads: UploadStore, quotas: QuotaStore) -> None:
    begun = uploads.create("dive.mp4", 7, owner="Jo")
    asked: list[Usage] = []
    quotas.reserve(begun, asked.append)
    quotas.reserve(uploads.create("dive.mp4", 5, owner="Bo"), None)
    quotas.renew(begun)
    assert asked == [Usage(0, 0)]
    assert quotas.usage("Jo") == Usage(1, 7)
    quotas.release(begun.id)
    quotas.release(begun.id)
    assert quotas.usage("Jo") == Usage(0, 0)


def test_what_is_refused_reserves_nothing(uploads: UploadStore, quotas: QuotaStore) -> None:
    def refuse(usage: Usage) -> None:
        raise ValueError(usage)

    with pytest.raises(ValueError, match="clips=0"):
        quotas.reserve(uploads.create("dive.mp4", 7, owner="Jo"), refuse)
    assert quotas.usage("Jo") == Usage(0, 0)


def test_an_upload_without_bytes_lapses_and_counts_again_when_it_goes_on(
    uploads: UploadStore, quotas: QuotaStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun = uploads.create("dive.mp4", 7, owner="Jo")
    quotas.reserve(begun, None)
    with monkeypatch.context() as later:
        later.setattr("app.store.quotas.ACTIVE", timedelta(seconds=-5))
        later.setattr("app.store.quotas.RENEWED", timedelta(seconds=-5))
        assert quotas.usage("Jo") == Usage(0, 0)
        # Another one that begins clears it away.
        quotas.reserve(uploads.create("dive.mp4", 1, owner="Bo"), None)
    assert quotas.usage("Jo") == Usage(0, 0)
    quotas.renew(begun)
    assert quotas.usage("Jo") == Usage(1, 7)


def test_an_upload_becomes_its_clip(
    clips: ClipStore, uploads: UploadStore, quotas: QuotaStore
) -> None:
    begun = uploads.create("dive.mp4", 5, owner="")
    quotas.reserve(begun, None)
    add_clip(clips, key=begun.id)
    assert quotas.usage("") == Usage(1, 5)
