"""Files appear whole or not at all."""

from pathlib import Path

import pytest

from app.store.atomic_files import publish


def test_a_published_file_replaces_what_was_there(tmp_path: Path) -> None:
    partial, target = tmp_path / "new.part", tmp_path / "file"
    partial.write_bytes(b"new")
    target.write_bytes(b"old")
    publish(partial, target)
    assert target.read_bytes() == b"new"
    assert not partial.exists()


def test_a_file_that_cannot_be_published_is_left_to_the_caller(tmp_path: Path) -> None:
    partial = tmp_path / "new.part"
    partial.write_bytes(b"new")
    with pytest.raises(OSError, match="missing"):
        publish(partial, tmp_path / "missing" / "file")
    assert partial.exists()
