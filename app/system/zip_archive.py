"""Zip archives from users: opened and unpacked without trusting their names and sizes.

Names never become paths, and sizes are counted while files are written.
"""

from __future__ import annotations

import errno
import lzma
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from zipfile import ZipFile, ZipInfo

from app.recognition.errors import OsgError

_DAMAGE = (
    zipfile.BadZipFile,
    RuntimeError,  # encrypted, or compressed by a method that Python does not know
    UnicodeDecodeError,
    EOFError,
    zlib.error,
    lzma.LZMAError,
)
"""Errors from reading a damaged, encrypted or unusual archive, besides some `OSError`."""

_DAMAGE_NUMBERS = (None, errno.EINVAL)
"""Error numbers of an `OSError` that means damage: bz2's has none, and an offset before the file's
start is invalid. All others come from the disk."""

_PIECE = 1024 * 1024
"""Bytes unpacked at once; a file over the limit is detected before it fills memory or disk."""


class UnpackedTooLarge(Exception):
    """Raised when an archive unpacks to more than is allowed.

    Parameters
    ----------
    name
        Plain name of the file that exceeds the limit.

    """

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


@contextmanager
def open_archive(path: Path, called: str, refusal: type[OsgError]) -> Iterator[ZipFile]:
    """Open an archive.

    Parameters
    ----------
    path
        The archive.
    called
        Name of the archive in the error.
    refusal
        Class of the error to raise.

    Raises
    ------
    OsgError
        An error of class `refusal`, when the archive is damaged, encrypted or of an unusual kind.

    """
    try:
        with ZipFile(path) as archive:
            yield archive
    except (*_DAMAGE, OSError) as error:
        if isinstance(error, OSError) and error.errno not in _DAMAGE_NUMBERS:
            raise
        raise refusal(
            f"{called} is a damaged, encrypted or unusual zip "
            f"({str(error) or type(error).__name__}); pack the folder again, without a password"
        ) from error


def plain_name(entry: ZipInfo) -> str:
    """Return the name of an entry without its folders, separated by slashes or backslashes."""
    return PurePosixPath(entry.filename.replace("\\", "/")).name


def visible_files(archive: ZipFile) -> list[ZipInfo]:
    """Return the entries that are files, without hidden ones such as those of the macOS Finder."""
    return [entry for entry in listed_files(archive) if not plain_name(entry).startswith(".")]


def listed_files(archive: ZipFile) -> list[ZipInfo]:
    """Return the entries that are files; an entry without a name is not counted as one."""
    return [entry for entry in archive.infolist() if entry.filename and not entry.is_dir()]


def names_in(path: Path) -> list[str]:
    """Return the plain names of an archive's visible files; none when it cannot be read."""
    try:
        with open_archive(path, path.name, OsgError) as archive:
            return [plain_name(entry) for entry in visible_files(archive)]
    except OsgError:
        return []


def unpack(
    archive: ZipFile,
    entries: Mapping[str, ZipInfo],
    folder: Path,
    *,
    most_bytes: int,
    most_bytes_each: int | None = None,
) -> None:
    """Write entries of an archive into a folder.

    Parameters
    ----------
    archive
        The open archive.
    entries
        Entries by the name of the file to write.
    folder
        Existing folder.
    most_bytes
        Largest total size in bytes.
    most_bytes_each
        Largest size of one file in bytes; None for no limit.

    Raises
    ------
    UnpackedTooLarge
        When a limit is exceeded; files already written stay.

    """
    left = most_bytes
    for name, entry in entries.items():
        allowed = left if most_bytes_each is None else min(left, most_bytes_each)
        left -= _write(archive, entry, folder / name, allowed)


def _write(archive: ZipFile, entry: ZipInfo, place: Path, allowed: int) -> int:
    """Write an entry of at most `allowed` bytes and return its size."""
    size = 0
    with archive.open(entry) as packed, place.open("wb") as file:
        while piece := packed.read(_PIECE):
            size += len(piece)
            if size > allowed:
                raise UnpackedTooLarge(place.name)
            file.write(piece)
    return size
