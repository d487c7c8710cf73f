"""Staging: dangerous archives are refused, and nothing is left behind."""

from __future__ import annotations

import stat
import tempfile
import zipfile
from pathlib import Path

import pytest

from app.bags import staging
from app.bags.staging import is_bag_archive, stage
from app.recognition.errors import BagError
from tests.bags.bag_files import zip_of


@pytest.fixture(autouse=True)
def scratch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Create temporary folders where the test can inspect them."""
    folder = tmp_path / "scratch"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.mark.parametrize(
    "name",
    ["../dive.mcap", "/etc/dive.mcap", "a/../../dive.mcap", "..\\dive.mcap", "C:\\dive.mcap"],
)
@pytest.mark.withstands(row="H14")
def test_paths_that_lead_out_are_refused(tmp_path: Path, scratch: Path, name: str) -> None:
    path = zip_of(tmp_path / "dive.zip", {name: b"x"})
    with pytest.raises(BagError, match="leads out of its folder"), stage(path):
        pass
    assert list(scratch.iterdir()) == []
    assert sorted(each.name for each in tmp_path.iterdir()) == ["dive.zip", "scratch"]


def test_links_are_refused(tmp_path: Path) -> None:
    entry = zipfile.ZipInfo("dive/dive.mcap")
    entry.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(tmp_path / "dive.zip", "w") as archive:
        archive.writestr(entry, "/etc/passwd")
    with pytest.raises(BagError, match="leads out"), stage(tmp_path / "dive.zip"):
        pass


@pytest.mark.withstands(row="H14")
def test_a_bomb_is_refused_by_what_it_says_and_by_what_it_does(
    tmp_path: Path, scratch: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = zip_of(tmp_path / "dive.zip", {"dive/dive.mcap": bytes(3_000_000)})
    monkeypatch.setattr(staging, "MOST_BYTES", 2_000_000)
    with pytest.raises(BagError, match="beyond the limit of"), stage(path):
        pass
    # A false directory entry: the size is stored twice, and readers check the second copy first.
    content = path.read_bytes()
    size, less = (3_000_000).to_bytes(4, "little"), (1_000_000).to_bytes(4, "little")
    path.write_bytes(content.replace(size, less))
    with pytest.raises(BagError), stage(path):
        pass
    assert list(scratch.iterdir()) == []


@pytest.mark.withstands(row="H14")
def test_a_million_entries_are_not_walked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = zip_of(tmp_path / "dive.zip", {f"{index}.mcap": b"" for index in range(12)})
    monkeypatch.setattr(staging, "MOST_ENTRIES", 10)
    with pytest.raises(BagError, match="12 entries, more than the limit of 10"), stage(path):
        pass


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ({"photo.jpg": b"x"}, "holds no dive recording"),
        ({"metadata.yaml": b"x"}, "holds no dive recording"),
        ({"a/x.mcap": b"x", "b/x.mcap": b"x"}, "more than one dive recording"),
        ({"x.mcap": b"x", "y.mcap": b"x"}, "2 storage files and no metadata.yaml"),
    ],
)
def test_archives_of_something_else_are_refused(
    tmp_path: Path, entries: dict[str, bytes], words: str
) -> None:
    path = zip_of(tmp_path / "dive.zip", entries)
    with pytest.raises(BagError, match=words), stage(path):
        pass


def test_only_what_belongs_to_the_recording_is_unpacked(tmp_path: Path) -> None:
    entries = {
        "dive/metadata.yaml": b"m",
        "dive/dive_0.mcap": b"0",
        "dive/dive_1.mcap": b"1",
        "dive/notes.txt": b"n",
        "__MACOSX/dive/._dive_0.mcap": b"f",
    }
    path = zip_of(tmp_path / "dive.zip", entries)
    assert is_bag_archive(path)
    with stage(path) as folder:
        found = {each.name: each.read_bytes() for each in folder.iterdir()}
        assert found == {"metadata.yaml": b"m", "dive_0.mcap": b"0", "dive_1.mcap": b"1"}
    assert not folder.exists()


@pytest.mark.withstands(row="H14")
def test_an_encrypted_archive_is_refused(tmp_path: Path) -> None:
    path = zip_of(tmp_path / "dive.zip", {"dive.mcap": b"secret"})
    content = bytearray(path.read_bytes())
    for start, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        content[content.index(start) + offset] |= 1
    path.write_bytes(content)
    with pytest.raises(BagError, match="without a password"), stage(path):
        pass


def test_other_archives_are_told_apart_without_unpacking(tmp_path: Path) -> None:
    assert not is_bag_archive(zip_of(tmp_path / "photos.zip", {"one.jpg": b"x"}))
    (tmp_path / "broken.zip").write_bytes(b"PK\x03\x04" + bytes(50))
    assert not is_bag_archive(tmp_path / "broken.zip")
    (tmp_path / "dive.mcap").write_bytes(b"\x89MCAP0\r\n")
    assert not is_bag_archive(tmp_path / "dive.mcap")
