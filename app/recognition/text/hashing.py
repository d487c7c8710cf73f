"""File hashes: the SHA-256 of files of any size, read in chunks."""

from __future__ import annotations

import hashlib
from pathlib import Path

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
