"""The SHA-256 of a file, which may be larger than memory."""

from __future__ import annotations

import hashlib
from pathlib import Path

CHUNK_BYTES = 2**18
"""Read at a time, as `hashlib.file_digest` does, which Python 3.10 does not have yet."""


def hash_file(path: Path) -> str:
    """Return the SHA-256 of a file's content, in hexadecimal.

    Raises
    ------
    OSError
        When it cannot be read.

    """
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(CHUNK_BYTES):
            digest.update(chunk)
    return digest.hexdigest()
