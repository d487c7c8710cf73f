"""File contents: atomic replacement, and the SHA-256 of files of any size.

With `write_atomically` a reader and a power cut find the old content or the new one, never a part.
`hash_file` reads in chunks.
"""

from __future__ import annotations

import hashlib
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

PUBLIC, PRIVATE = 0o666, 0o600
"""Permissions of a new file, of which the process's umask takes its share."""


@contextmanager
def replace_file(path: Path, mode: int = PUBLIC) -> Iterator[BinaryIO]:
    """Open a new file that takes the place of `path` once it is complete and on the disk.

    Raises
    ------
    OSError
        When it cannot be written; `path` is as it was, and no part is left.

    """
    partial = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        with os.fdopen(os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        partial.replace(path)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise
    with suppress(OSError):
        sync_directory(path.parent)


def sync_directory(directory: Path) -> None:
    """Make the names in `directory` durable; do nothing on systems that cannot open directories."""
    if os.name != "posix":
        return
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_atomically(path: Path, content: bytes) -> None:
    """Replace a file by one with this content; see `replace_file`."""
    with replace_file(path) as file:
        file.write(content)


CHUNK_BYTES = 2**18
"""Size of a chunk; `hashlib.file_digest`, which reads as much, needs Python 3.11."""


def hash_file(*paths: Path) -> str:
    """Return the SHA-256 of a file's content, or of several, one after the other, in hexadecimal.

    Raises
    ------
    OSError
        When it cannot be read.

    """
    digest = hashlib.sha256()
    for path in paths:
        with path.open("rb") as file:
            while chunk := file.read(CHUNK_BYTES):
                digest.update(chunk)
    return digest.hexdigest()
