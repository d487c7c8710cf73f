"""HDF5 check: refuses files that refer to others, need plug-ins or announce more than they hold.

The readers of HDF5 follow whatever a file says: external storage, links and virtual datasets open
any file of the machine, and a dataset without stored values has any size. The check only lists what
is there, and reads no values but texts, whose sizes are known only then.
"""

from __future__ import annotations

import importlib
import math
import zlib
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

import numpy as np

from app.recognition.errors import KeypointFileError

MOST_BYTES: Final = 512 * 1024 * 1024
"""Most bytes of all values: the most frames allowed, of ten people with 33 landmarks."""

MOST_ENTRIES: Final = 10_000
"""Most objects and attributes; SLEAP writes some twenty, and a few for each embedded video."""

MOST_TEXTS: Final = 100_000
"""Most texts of one dataset; there may be thousands of tracks."""

MOST_PACKED: Final = 1100
"""Bytes that one stored byte may stand for: Deflate's limit is 1032."""

SMALL: Final = 64 * 1024
"""Bytes of a dataset that may be empty."""

DEFLATE, SHUFFLE, FLETCHER = 1, 2, 3

FILTERS: Final = frozenset({DEFLATE, SHUFFLE, FLETCHER})
"""Filters that SLEAP uses, built into every HDF5; others would be loaded as plug-ins."""

PLACE: Final = 16
"""Bytes of a file that say where a text is, which the library counts as 8."""

CHECKSUM: Final = 4
"""Bytes of Fletcher's checksum, which may be packed with the values."""


def require_self_contained(path: Path) -> None:
    """Refuse an HDF5 file that is not complete in itself; needs h5py.

    Raises
    ------
    KeypointFileError
        When the file refers to others, needs a filter that is not built in, or announces more than
        it holds or than is allowed.
    OSError, RuntimeError, ValueError, KeyError
        When it is damaged, or no HDF5 at all.

    """
    h5py = importlib.import_module("h5py")
    while h5py.h5pl.size():  # No plug-in is ever loaded.
        h5py.h5pl.remove(0)
    file = h5py.h5f.open(bytes(path), h5py.h5f.ACC_RDONLY)
    try:
        _Check(h5py, path).run(h5py.h5o.open(file, b"/"))
    finally:
        file.close()


class _Check:
    """Goes through all objects of a file.

    Parameters
    ----------
    h5py
        The library.
    path
        The file, for messages.

    """

    def __init__(self, h5py: Any, path: Path) -> None:
        self._h5py = h5py
        self._path = path
        self._file_bytes = path.stat().st_size
        self._bytes = self._stored = self._entries = 0

    def run(self, root: Any) -> None:
        """Check the objects from the root group on, each once: hard links may form circles."""
        h5o, h5g, h5d = self._h5py.h5o, self._h5py.h5g, self._h5py.h5d
        waiting, seen = [root], {h5o.get_info(root).addr}
        while waiting:
            each = waiting.pop()
            self._attributes(each)
            if isinstance(each, h5d.DatasetID):
                self._dataset(each)
            if not isinstance(each, h5g.GroupID):
                continue
            for name in self._hard_links(each):
                child = h5o.open(each, name)
                if (place := h5o.get_info(child).addr) not in seen:
                    seen.add(place)
                    waiting.append(child)

    def _hard_links(self, group: Any) -> list[bytes]:
        names: list[bytes] = []

        def take(name: bytes) -> bool | None:
            names.append(name)
            # The library goes on until it is given an answer; an error would not come through.
            return len(names) > MOST_ENTRIES or None

        group.links.iterate(take)
        self._count_entries(len(names))
        for name in names:
            if group.links.get_info(name).type != self._h5py.h5l.TYPE_HARD:
                raise self._refusal(f"{_shown(name)} is a link to another file or place")
        return names

    def _attributes(self, owner: Any) -> None:
        h5a = self._h5py.h5a
        for index in range(h5a.get_num_attrs(owner)):
            self._count_entries(1)
            attribute = h5a.open(owner, index=index)
            kind, name = attribute.get_type(), _shown(attribute.name)
            count = attribute.get_space().get_simple_extent_npoints()
            if self._varies(kind, name) and count > 1:
                raise self._refusal(f"the attribute {name} is a list of texts")
            self._add(count * kind.get_size(), name)

    def _dataset(self, dataset: Any) -> None:
        name = _shown(self._h5py.h5i.get_name(dataset) or b"")
        plan = dataset.get_create_plist()
        if plan.get_external_count():
            raise self._refusal(f"the values of {name} are in another file")
        if plan.get_layout() == self._h5py.h5d.VIRTUAL:
            raise self._refusal(f"{name} is composed of other datasets")
        filters = [plan.get_filter(index)[0] for index in range(plan.get_nfilters())]
        if unknown := [each for each in filters if each not in FILTERS or filters.count(each) > 1]:
            raise self._refusal(f"{name} is packed by filter {unknown[0]}, alone or twice")
        kind, shape = dataset.get_type(), dataset.get_space().get_simple_extent_dims() or ()
        count = math.prod(shape)
        announced, stored = count * kind.get_size(), dataset.get_storage_size()
        if plan.get_layout() == self._h5py.h5d.CHUNKED:
            self._add(math.prod(plan.get_chunk()) * kind.get_size(), name, remember=False)
        self._add(announced, name)
        self._stored += stored
        most = stored * (MOST_PACKED if filters else 1)
        if announced > max(most, SMALL) or self._stored > self._file_bytes:
            raise self._refusal(f"{name} announces {announced} bytes and holds {stored}")
        if DEFLATE in filters:
            if set(filters[filters.index(DEFLATE) + 1 :]) - {FLETCHER}:
                raise self._refusal(f"{name} is changed once more after it was packed")
            each = math.prod(plan.get_chunk()) * max(kind.get_size(), PLACE)
            self._require_chunks_of(each + CHECKSUM, dataset, name)
        if self._varies(kind, name):
            self._texts(dataset, shape, count, name)

    def _require_chunks_of(self, most: int, dataset: Any, name: str) -> None:
        """Refuse chunks that unpack to more: the library would make room for all of it."""
        places: list[tuple[int, ...]] = []
        dataset.chunk_iter(lambda chunk: places.append(chunk.chunk_offset))
        for place in places:
            _, packed = dataset.read_direct_chunk(place)
            # What was stored unpacked fails here, and is then as long as it is.
            with suppress(zlib.error):
                if len(zlib.decompressobj().decompress(packed, most + 1)) > most:
                    raise self._refusal(f"a part of {name} unpacks to more than it announces")

    def _texts(self, dataset: Any, shape: tuple[int, ...], count: int, name: str) -> None:
        """Count the bytes of texts one by one: thousands may refer to the same megabytes."""
        if count > MOST_TEXTS:
            raise self._refusal(f"{name} has {count} texts, more than {MOST_TEXTS}")
        values = self._h5py.Dataset(dataset)
        for index in np.ndindex(*shape):
            value = values[index]
            size = len(value) if isinstance(value, bytes | str) else getattr(value, "nbytes", 0)
            self._add(size, name)

    def _varies(self, kind: Any, name: str) -> bool:
        """Return whether values are of varying size; refuse those inside others, and references."""
        h5t = self._h5py.h5t
        if kind.detect_class(h5t.REFERENCE):
            raise self._refusal(f"{name} holds references")
        if kind.get_class() == h5t.STRING:
            return bool(kind.is_variable_str())
        if kind.get_class() == h5t.VLEN:
            self._require_fixed(kind.get_super(), name)
            return True
        self._require_fixed(kind, name)
        return False

    def _require_fixed(self, kind: Any, name: str) -> None:
        h5t = self._h5py.h5t
        varies = kind.get_class() == h5t.STRING and kind.is_variable_str()
        if varies or kind.get_class() == h5t.VLEN:
            raise self._refusal(f"{name} holds lists in lists")
        if kind.get_class() == h5t.ARRAY:
            self._require_fixed(kind.get_super(), name)
        if kind.get_class() == h5t.COMPOUND:
            for index in range(kind.get_nmembers()):
                self._require_fixed(kind.get_member_type(index), name)

    def _count_entries(self, count: int) -> None:
        self._entries += count
        if self._entries > MOST_ENTRIES:
            raise self._refusal(f"it has more than {MOST_ENTRIES} objects and attributes")

    def _add(self, size: int, name: str, *, remember: bool = True) -> None:
        if self._bytes + size > MOST_BYTES:
            raise self._refusal(f"it unpacks to more than {MOST_BYTES / 1e6:.0f} MB, at {name}")
        self._bytes += size if remember else 0

    def _refusal(self, reason: str) -> KeypointFileError:
        return KeypointFileError(
            f"{self._path} is refused: {reason}; export it again with SLEAP, as one file that "
            "is complete in itself and holds the part with the gestures"
        )


def _shown(name: bytes) -> str:
    """Return a name for messages."""
    return repr(name[:80].decode("utf-8", "replace"))
