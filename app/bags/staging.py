"""Staging of a dive recording for rosbags: unpack archives, give files their ending."""

from __future__ import annotations

import stat
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath
from zipfile import ZipFile, ZipInfo

from app.bags.bag_kind import METADATA, BagKind, kind_of, split_parts
from app.bags.mcap_chunks import load_zstd
from app.recognition.errors import BagError
from app.system.stand_in import stand_in
from app.system.zip_archive import (
    UnpackedTooLarge,
    listed_files,
    names_in,
    open_archive,
    plain_name,
    unpack,
    visible_files,
)

MOST_ENTRIES = 1000
"""Most entries of an archive. A recording split every minute for a whole day has 1440 files, but
nobody uploads a day at once, and a directory of a million entries takes minutes to read."""

MOST_BYTES = 4 * 512 * 1024 * 1024
"""Most bytes after unpacking: four times the largest upload. Pictures in a recording are compressed
already, and noise keeps raw ones from shrinking below a third; smaller archives are no
recordings."""

PIECE = 1024 * 1024
"""Bytes unpacked at once."""

ENDINGS: dict[BagKind, str] = {"mcap": ".mcap", "sqlite3": ".db3"}
"""File endings by which rosbags recognises the two storages."""


LOG = "-wal"
"""What SQLite adds to a file's name for that of its write-ahead log."""

ODD = frozenset("%?#")
"""Characters of a path by which SQLite, which is given an address, reads another place."""


@contextmanager
def stage(path: Path) -> Iterator[Path]:
    """Yield the path from which a recording can be read; unpacked files are removed at the end.

    Raises
    ------
    BagError
        When `path` is no dive recording, or an archive that cannot be unpacked safely.

    """
    kind = _known_kind(path)
    beside = path.iterdir() if kind == "folder" else [path.with_name(f"{path.name}{LOG}")]
    _require_no_log(
        (each.name for each in beside if each.is_file() and each.stat().st_size), path.name
    )
    if kind == "folder":
        _require_plain([each.name for each in path.iterdir()], path.name)
        if not set(str(path.resolve())) & ODD:
            yield path
            return
    with tempfile.TemporaryDirectory(prefix="bag-") as made:
        folder = Path(made)
        if kind == "folder":
            place = folder / "recording"
            place.symlink_to(path.resolve(), target_is_directory=True)
            yield place
        elif kind == "zip":
            yield _unpack(path, folder)
        else:
            place = folder / f"recording{ENDINGS[kind]}"
            try:
                stand_in(path, place)
            except OSError as error:
                raise BagError(
                    f"{path.name} can be neither linked nor copied to {folder}; free space"
                ) from error
            yield place


def _known_kind(path: Path) -> BagKind:
    if not path.exists():
        raise BagError(f"{path} does not exist; give the path of a dive recording")
    kind = kind_of(path)
    if kind is None:
        raise BagError(
            f"{path.name} is no dive recording: neither a folder with {METADATA} nor an MCAP, "
            "sqlite3 or zip file; give a recording made by `ros2 bag record`"
        )
    if kind == "ros1":
        raise BagError(
            f"{path.name} is a recording of ROS 1; convert it with `rosbags-convert --src "
            f"{path.name} --dst FOLDER` (pip install rosbags) and use the folder"
        )
    return kind


def _unpack(path: Path, folder: Path) -> Path:
    """Unpack an archive of a recording's folder, or of its one file, flat into `folder`."""
    with open_archive(path, path.name, BagError) as archive:
        entries = _select_entries(archive, path.name)
        try:
            unpack(archive, entries, folder, most_bytes=MOST_BYTES)
        except UnpackedTooLarge as error:
            raise _too_large(path.name, MOST_BYTES) from error
    _require_small(folder, path.name)
    if (folder / METADATA).is_file() or split_parts(folder):
        return folder
    files = sorted(folder.iterdir())
    if len(files) != 1:
        raise BagError(
            f"{path.name} holds {len(files)} storage files and no {METADATA}, and their names do "
            "not number them as parts of one recording (dive_0.mcap, dive_1.mcap), so their order "
            "is not known; pack the recording's whole folder"
        )
    return files[0]


def _select_entries(archive: ZipFile, name: str) -> dict[str, ZipInfo]:
    """Return the entries of the recording by name, after a check of all entries."""
    entries = listed_files(archive)
    if len(entries) > MOST_ENTRIES:
        raise BagError(
            f"{name} has {len(entries)} entries, more than the limit of {MOST_ENTRIES}; pack one "
            "recording's folder"
        )
    for entry in entries:
        parts = PurePosixPath(entry.filename.replace("\\", "/")).parts
        leaves = ".." in parts or any("/" in part or ":" in part for part in parts[:1])
        if leaves or stat.S_ISLNK(entry.external_attr >> 16):
            raise BagError(
                f"{name} has an entry that leads out of its folder ({entry.filename[:80]!r}); "
                "pack the recording's folder again, without links"
            )
    listed = visible_files(archive)
    _require_no_log((plain_name(entry) for entry in listed if entry.file_size), name)
    files = [entry for entry in listed if _belongs(plain_name(entry))]
    _require_plain(map(plain_name, files), name)
    wanted = {plain_name(entry): entry for entry in files}
    if not wanted.keys() - {METADATA}:
        raise BagError(
            f"{name} holds no dive recording (no .mcap and no .db3 file); pack a folder made by "
            "`ros2 bag record`"
        )
    if len(wanted) < len(files):
        raise BagError(f"{name} holds more than one dive recording; pack one folder at a time")
    if (total := sum(entry.file_size for entry in files)) > MOST_BYTES:
        raise _too_large(name, total)
    return wanted


def _require_plain(files: Iterable[str], name: str) -> None:
    """Refuse names that SQLite, which is given an address, reads as another place."""
    if odd := [each for each in files if _belongs(each) and set(each) & ODD]:
        raise BagError(
            f"{name} has a file with %, ? or # in its name ({odd[0][:80]!r}); rename it, there and "
            f"in {METADATA}"
        )


def _require_no_log(files: Iterable[str], name: str) -> None:
    """Refuse a recording whose last messages are not in its file, which would seem to be empty."""
    if found := next((each for each in files if each.endswith(f".db3{LOG}")), None):
        raise BagError(
            f"{name}: messages wait in {found[:80]!r}, as where the recorder was killed; move them "
            f'into the recording, once, by `sqlite3 {found[:80].removesuffix(LOG)} "PRAGMA '
            'wal_checkpoint"`'
        )


def _require_small(folder: Path, name: str) -> None:
    """Refuse files that the reader would unpack a second time to more than is allowed."""
    zstd = load_zstd()
    left = MOST_BYTES
    for path in folder.iterdir():
        # What is not packed by zstd raises this at once.
        with suppress(zstd.ZstdError, EOFError), zstd.open(path, "rb") as file:
            while piece := file.read(PIECE):
                left -= len(piece)
                if left < 0:
                    raise _too_large(name, MOST_BYTES)


def _belongs(name: str) -> bool:
    """Return whether a file is part of a recording, by its name."""
    return name == METADATA or name.removesuffix(".zstd").endswith((".mcap", ".db3"))


def _too_large(name: str, size: int) -> BagError:
    return BagError(
        f"{name} unpacks to {size / 1e9:.1f} GB or more, beyond the limit of "
        f"{MOST_BYTES / 1e9:.1f} GB; cut out the part with the gestures (`ros2 bag convert`)"
    )


def is_bag(path: Path) -> bool:
    """Return whether `path` is a dive recording, by its first bytes or an archive's names."""
    kind = kind_of(path)
    return is_bag_archive(path) if kind == "zip" else kind is not None


def is_bag_archive(path: Path) -> bool:
    """Return whether the zip at `path` looks like a dive recording; only names are read."""
    return kind_of(path) == "zip" and any(map(_belongs, names_in(path)))
