"""A file is replaced as a whole or not at all."""

from contextlib import suppress
from pathlib import Path

from app.recognition.text.atomic_files import PRIVATE, replace_file, write_atomically


def test_a_file_is_replaced_and_no_part_is_left(tmp_path: Path) -> None:
    file = tmp_path / "language.json"
    file.write_bytes(b"old")
    write_atomically(file, b"new")
    assert file.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [file]


def test_a_write_that_breaks_off_leaves_the_old_file_and_no_part(tmp_path: Path) -> None:
    file = tmp_path / "language.json"
    file.write_bytes(b"old")
    with suppress(OSError), replace_file(file) as part:
        part.write(b"ne")
        raise OSError("disk is full")
    assert file.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [file]


def test_a_reader_finds_the_old_content_until_the_new_one_is_whole(tmp_path: Path) -> None:
    file = tmp_path / "language.json"
    file.write_bytes(b"old")
    with replace_file(file) as part:
        part.write(b"new")
        assert file.read_bytes() == b"old"


def test_a_private_file_is_its_owners_alone(tmp_path: Path) -> None:
    file = tmp_path / "recording.npz"
    with replace_file(file, PRIVATE) as part:
        part.write(b"poses")
    assert file.stat().st_mode & 0o077 == 0
