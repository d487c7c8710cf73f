"""Staging: dangerous archives are refused, and nothing is left behind."""

from __future__ import annotations

import contextlib
import shutil
import sqlite3
import stat
import tempfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
from backports import zstd
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from app.bags import staging
from app.bags.bag import open_bag
from app.bags.staging import is_bag_archive, stage
from app.recognition.errors import BagError
from tests.bags.bag_files import (
    START,
    Storage,
    file_of,
    message,
    raw,
    write_bag,
    zip_of,
    zipped,
)


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
        ({"x_0.mcap": b"x", "x_2.mcap": b"x"}, "order is not known"),
        ({"x_0.mcap": b"x", "y_1.mcap": b"x"}, "order is not known"),
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


def test_a_file_that_unpacks_twice_is_counted_at_its_last_size(
    tmp_path: Path, scratch: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(staging, "MOST_BYTES", 2_000_000)
    for size, allowed in ((1_900_000, True), (3_000_000, False)):
        content = {"metadata.yaml": b"m", "dive.mcap.zstd": zstd.compress(bytes(size))}
        path = zip_of(tmp_path / "dive.zip", content)
        if allowed:
            with stage(path):
                pass
            continue
        with pytest.raises(BagError, match="beyond the limit of"), stage(path):
            pass
    assert list(scratch.iterdir()) == []


def test_a_name_that_sqlite_reads_as_another_place_opens_nothing(tmp_path: Path) -> None:
    # The recording of somebody else, beside the folder into which ours is unpacked.
    image = message("std_msgs/msg/String", "secret")
    other = write_bag(tmp_path / "other", [("/secret", image, START)], "sqlite3")
    own = write_bag(tmp_path / "own", [("/own", image, START)], "sqlite3")
    (own / "own.db3").rename(own / "own")
    shutil.copy(other / "other.db3", tmp_path / "scratch" / "other.db3")
    name = "%2e%2e%2fother.db3"
    metadata = (own / "metadata.yaml").read_text().replace("own.db3", f"'{name}'")
    entries = {name: (own / "own").read_bytes(), "metadata.yaml": metadata.encode()}
    path = zip_of(tmp_path / "dive.zip", entries)
    with pytest.raises(BagError, match="in its name"), open_bag(path) as bag:
        pytest.fail(f"opened a recording of {[topic.name for topic in bag.topics]}")


def test_a_folder_that_sqlite_reads_as_another_one_is_read_itself(tmp_path: Path) -> None:
    for place, text in (("dives", "another one"), ("own", "own")):
        said = message("std_msgs/msg/String", text)
        (tmp_path / place).mkdir()
        write_bag(tmp_path / place / "dive", [("/said", said, START)], "sqlite3")
    folder = (tmp_path / "own").rename(tmp_path / "%64ives") / "dive"
    with open_bag(folder) as bag:
        assert [each.content.data for each in bag.messages("/said")] == ["own"]


@pytest.mark.withstands(row="H28")
@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_metadata_that_names_files_elsewhere_opens_nothing(
    tmp_path: Path, storage: Storage
) -> None:
    image = message("std_msgs/msg/String", "secret")
    other = write_bag(tmp_path / "other", [("/secret", image, START)], storage)
    own = write_bag(tmp_path / "own", [("/own", image, START)], storage)
    metadata = (own / "metadata.yaml").read_text()
    for place in (f"../../other/{file_of(other).name}", str(file_of(other))):
        changed = metadata.replace(file_of(own).name, place)
        entries = {
            file_of(own).name: file_of(own).read_bytes(),
            "metadata.yaml": changed.encode(),
        }
        path = zip_of(tmp_path / "dive.zip", entries)
        with pytest.raises((BagError, OSError), match="missing"), open_bag(path):
            pass


@pytest.mark.withstands(row="H28")
def test_metadata_runs_no_code(tmp_path: Path) -> None:
    marker = tmp_path / "marker"
    own = write_bag(tmp_path / "own", [("/own", message("std_msgs/msg/String", "x"), START)])
    code = f"!!python/object/apply:os.mkdir ['{marker}']\n"
    entries = {file_of(own).name: file_of(own).read_bytes(), "metadata.yaml": code.encode()}
    path = zip_of(tmp_path / "dive.zip", entries)
    with pytest.raises(BagError), open_bag(path):
        pass
    assert not marker.exists()


def test_a_message_definition_runs_no_code(tmp_path: Path) -> None:
    marker = tmp_path / "marker"
    attack = f"__import__('pathlib').Path('{marker}').touch()"
    for text in (
        f"string A='{attack}'\nstring data",
        f'string A=""+{attack}+""\nstring data',
        f"string data {attack}",
        f"string data\n{attack}",
        f"uint8[{attack}] data",
        f"string data; {attack}",
    ):
        with contextlib.suppress(Exception):
            store = get_typestore(Stores.EMPTY)
            store.register(get_types_from_msg(text, "std_msgs/msg/String"))
            store.deserialize_cdr(b"\0\1\0\0\4\0\0\0abc\0", "std_msgs/msg/String")
    assert not marker.exists()


def test_messages_that_wait_in_a_log_beside_the_file_are_named(tmp_path: Path) -> None:
    """A recorder that is killed leaves them there, and the file itself seems to be empty."""
    rows = [("/camera", raw(np.zeros((2, 2, 3), np.uint8), "rgb8", START), START)]
    folder = write_bag(tmp_path / "dive", rows, "sqlite3")
    file = file_of(folder)
    whole = sqlite3.connect(file)
    whole.execute("PRAGMA journal_mode=WAL")
    whole.execute("PRAGMA wal_autocheckpoint=0")
    whole.execute("UPDATE messages SET timestamp = timestamp + 1")
    whole.commit()
    killed = Path(shutil.copytree(folder, tmp_path / "killed"))
    whole.close()
    for path in (killed, killed / file.name, zipped(killed)):
        words = rf"messages wait in '{file.name}-wal'.*sqlite3 {file.name}"
        with pytest.raises(BagError, match=words), open_bag(path):
            pass
    # What the message says to do.
    with contextlib.closing(sqlite3.connect(killed / file.name)) as once:
        once.execute("PRAGMA wal_checkpoint")
    for path in (folder, killed):
        with open_bag(path) as bag:
            assert bag.topics[0].messages == 1
