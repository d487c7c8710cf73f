"""Archives that people send: whatever is in them, a plain refusal at worst."""

from __future__ import annotations

import zipfile
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.recognition.errors import OsgError
from app.system.zip_archive import UnpackedTooLarge, names_in, open_archive, unpack, visible_files

METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)


class Refused(OsgError):
    """What the tests want raised."""


def archive_of(path: Path, entries: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> Path:
    with zipfile.ZipFile(path, "w", method) as archive:
        for name, content in entries.items():
            archive.writestr(name, content)
    return path


def unpacked(path: Path, folder: Path, most: int, most_each: int | None = None) -> None:
    folder.mkdir(exist_ok=True)
    with open_archive(path, "the archive", Refused) as archive:
        entries = {str(index): each for index, each in enumerate(visible_files(archive))}
        unpack(archive, entries, folder, most_bytes=most, most_bytes_each=most_each)


def test_an_entry_without_a_name_is_no_file(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "z", {"nameless": b"x", "one.json": b""})
    # Both the entry and the directory hold the name; one that begins with NUL is cut to none.
    path.write_bytes(path.read_bytes().replace(b"nameless", b"\0ameless"))
    assert names_in(path) == ["one.json"]


def test_plain_names_are_told_without_folders_and_notes_of_the_finder(tmp_path: Path) -> None:
    entries = {"a/": b"", "a/one.json": b"", "..\\two.json": b"", "__MACOSX/a/._one.json": b""}
    assert names_in(archive_of(tmp_path / "z", entries)) == ["one.json", "two.json"]


@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x03\x04" + bytes(60)])
def test_what_is_no_archive_has_no_names_and_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "z"
    path.write_bytes(content)
    assert names_in(path) == []
    with pytest.raises(Refused, match=r"^the archive is a damaged.*pack the folder again"):
        unpacked(path, tmp_path / "out", 10)


def test_bytes_are_counted_while_they_are_written(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "z", {"one": bytes(3_000_000), "two": bytes(2_000_000)})
    unpacked(path, tmp_path / "out", most=5_000_000, most_each=3_000_000)
    sizes = {each.name: each.stat().st_size for each in (tmp_path / "out").iterdir()}
    assert sizes == {"0": 3_000_000, "1": 2_000_000}


@pytest.mark.parametrize(
    ("most", "most_each", "name"), [(4_999_999, None, "1"), (9**9, 2_999_999, "0")]
)
def test_too_many_bytes_are_noticed_at_a_file(
    tmp_path: Path, most: int, most_each: int | None, name: str
) -> None:
    path = archive_of(tmp_path / "z", {"one": bytes(3_000_000), "two": bytes(2_000_000)})
    with pytest.raises(UnpackedTooLarge) as caught:
        unpacked(path, tmp_path / "out", most, most_each)
    assert caught.value.name == name
    written = sum(each.stat().st_size for each in (tmp_path / "out").iterdir())
    assert written <= most


@pytest.fixture(scope="module", params=METHODS)
def content(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    entries = {
        "dive/caf\N{LATIN SMALL LETTER E WITH ACUTE}.json": bytes(range(64)) * 8,
        "b.json": b"{}",
    }
    return archive_of(tmp_path_factory.mktemp("whole") / "z", entries, request.param).read_bytes()


@given(data=st.data(), mask=st.integers(1, 255))
def test_a_changed_byte_leaves_a_readable_archive_or_a_refusal(
    content: bytes, tmp_path_factory: pytest.TempPathFactory, data: st.DataObject, mask: int
) -> None:
    place = data.draw(st.integers(0, len(content) - 1))
    damaged = bytearray(content)
    damaged[place] ^= mask
    folder = tmp_path_factory.getbasetemp() / "damaged"
    folder.mkdir(exist_ok=True)
    path = folder / "z"
    path.write_bytes(damaged)
    assert len(names_in(path)) <= 2
    with suppress(Refused, UnpackedTooLarge):
        unpacked(path, folder / "out", most=10_000)


def test_an_archive_that_is_not_there_is_no_damaged_one(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        unpacked(tmp_path / "z", tmp_path / "out", 10)
