"""Memory of dive recordings: how much of a chunk, of a message or of a row may be unpacked.

Libraries compare the size of a chunk with its header only when all of it is unpacked, and that of a
message or of a row of SQLite with nothing: 56 kB hold gigabytes of zeros.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from functools import partial
from itertools import accumulate
from types import ModuleType, SimpleNamespace
from typing import IO, TYPE_CHECKING, Any, Final

from app.recognition.errors import BagError

if TYPE_CHECKING:
    import apsw
    from mcap.records import ChunkIndex
    from rosbags.rosbag2 import Reader

MOST_UNPACKED: Final = 256 * 1024 * 1024
"""Bytes of an MCAP file's chunks that are unpacked together: of those that overlap in time. A chunk
of rosbag2 has less than a megabyte, or one picture; the largest raw ones have 100 MB."""

SQLITE_LIMIT_LENGTH: Final = 0
"""Number of the limit of the bytes of a text, blob or row (sqlite3_limit)."""

CHUNK_HEAD: Final = 9 + 40
"""Bytes of a chunk's record before its data, besides the name of its compression."""

FRAME_HEAD: Final = 18
"""Most bytes of the head of a frame of zstd (RFC 8878, 3.1.1.1), which states its size."""


def load_zstd() -> ModuleType:
    """Return the module of zstd that the reader of recordings brings along."""
    if sys.version_info >= (3, 14):
        from compression import zstd
    else:
        from backports import zstd
    return zstd


def limit_unpacking() -> None:
    """Make rosbags unpack no more than is allowed, and of a chunk no more than its header says."""
    import apsw
    from lz4.frame import LZ4FrameDecompressor
    from rosbags.rosbag2 import reader, storage_mcap

    zstd = load_zstd()
    starts = {"lz4": LZ4FrameDecompressor, "zstd": zstd.ZstdDecompressor}
    for name, start in starts.items():
        storage_mcap.DECOMPRESSORS[name] = partial(unpack_chunk, start)
    vars(reader)["zstd"] = SimpleNamespace(open=zstd.open, decompress=_unpack_message)
    if _limit_rows not in apsw.connection_hooks:
        apsw.connection_hooks.append(_limit_rows)


def _unpack_message(packed: bytes) -> bytes:
    zstd = load_zstd()
    stated = zstd.get_frame_info(packed[:FRAME_HEAD]).decompressed_size
    found = unpack_chunk(zstd.ZstdDecompressor, packed, stated or MOST_UNPACKED)
    if len(found) > (stated or MOST_UNPACKED):
        raise too_large(len(found))
    return found


def _limit_rows(connection: apsw.Connection) -> None:
    connection.limit(SQLITE_LIMIT_LENGTH, MOST_UNPACKED)


def unpack_chunk(start: Callable[[], Any], packed: bytes, size: int) -> bytes:
    """Unpack a chunk, each of its frames by its own decompressor; at most `size` and one byte.

    Raises
    ------
    BagError
        When it says that it holds too much.

    """
    if size > MOST_UNPACKED:
        raise too_large(size)
    found = b""
    while packed and len(found) <= size:
        frame = start()
        found += frame.decompress(packed, max_length=size + 1 - len(found))
        packed = (frame.unused_data or b"") if frame.eof else b""
    return found


def require_little_overlap(reader: Reader) -> None:
    """Refuse MCAP files of whose chunks too many overlap: they are unpacked together."""
    for storage in getattr(reader.storage, "storages", [reader.storage]):
        changes = []
        for chunk in getattr(storage, "chunks", ()):
            changes.append((chunk.message_start_time, chunk.uncompressed_size))
            changes.append((chunk.message_end_time + 1, -chunk.uncompressed_size))
        most = max(accumulate(size for _, size in sorted(changes)), default=0)
        if most > MOST_UNPACKED:
            raise too_large(most)


def too_large(size: int) -> BagError:
    """Return the error of chunks or messages that would take too much memory."""
    return BagError(
        f"it holds chunks or messages of at least {size / 1e6:.0f} MB that must be unpacked at "
        f"once, and the limit is {MOST_UNPACKED / 1e6:.0f}; write it with smaller ones (mcap "
        "compress --chunk-size)"
    )


def require_stated_sizes(file: IO[bytes], chunks: Iterable[ChunkIndex]) -> None:
    """Check that a session's chunks hold as much as their index says, and no more than is allowed.

    Raises
    ------
    BagError
        When one does not.

    """
    zstd = load_zstd()
    for chunk in chunks:
        if chunk.uncompressed_size > MOST_UNPACKED:
            raise too_large(chunk.uncompressed_size)
        file.seek(chunk.chunk_start_offset + CHUNK_HEAD + len(chunk.compression))
        stated = chunk.compressed_size
        if chunk.compression == "zstd":
            stated = zstd.get_frame_info(file.read(FRAME_HEAD)).decompressed_size
        if chunk.compression not in ("", "zstd") or stated != chunk.uncompressed_size:
            raise BagError("the session's chunks are not as its index says; export it again")
