"""Strict JSON: a parser with limits for untrusted files, and the canonical form (RFC 8785)."""

from __future__ import annotations

import codecs
import json
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import rfc8785

MAX_DEPTH = 32
"""Deepest nesting read: a language file needs seven levels, a robot's command a few more."""

MAX_SAFE_INTEGER = 2**53 - 1
"""Largest integer that every JSON reader keeps exactly (RFC 7493, I-JSON)."""

MAX_FAULTS = 20
"""Most faults listed at once: enough to correct a file by hand, few enough to read."""

_QUOTE = ord('"')
_DEPTH_OF_BYTE = np.zeros(256, dtype=np.int8)
_DEPTH_OF_BYTE[list(b"[{")] = 1
_DEPTH_OF_BYTE[list(b"]}")] = -1


@dataclass(frozen=True)
class Fault:
    """An error in a JSON document, and where it is.

    Attributes
    ----------
    pointer
        JSON pointer (RFC 6901), ``""`` for the whole document.
    message
        What is wrong.

    """

    pointer: str
    message: str


class StrictJSONError(ValueError):
    """Raised when text is not acceptable JSON; `faults` has at least one entry."""

    def __init__(self, faults: list[Fault]) -> None:
        super().__init__("; ".join(f"{fault.pointer}: {fault.message}" for fault in faults))
        self.faults = faults


class _ObjectWithDuplicates(dict[str, Any]):
    """A JSON object in which a key occurs twice."""

    duplicates: list[str]


def is_utf16(head: bytes) -> bool:
    """Return whether a text that begins with `head` is UTF-16, by its byte-order mark."""
    return head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))


def read_json(content: bytes, max_bytes: int, max_depth: int = MAX_DEPTH) -> Any:
    """Parse UTF-8 JSON of limited size and depth that every reader understands alike.

    Parameters
    ----------
    content
        The file.
    max_bytes
        Largest size read.
    max_depth
        Deepest nesting read.

    Raises
    ------
    StrictJSONError
        When the size or the depth is beyond the limit (checked before parsing), the text is not
        UTF-8 or not JSON, or it holds duplicate keys, NaN, infinite or overflowing numbers,
        integers beyond `MAX_SAFE_INTEGER`, or lone surrogates.

    """
    if len(content) > max_bytes:
        size = f"{len(content):,} bytes, the limit is {max_bytes:,}"
        raise StrictJSONError([Fault("", f"the file is too large: {size}")])
    if (depth := _depth(content)) > max_depth:
        raise StrictJSONError([Fault("", f"nested {depth} deep, the limit is {max_depth}")])
    try:
        document = json.loads(
            # Editors of Windows begin a text with a byte-order mark.
            content.removeprefix(codecs.BOM_UTF8).decode("utf-8"),
            object_pairs_hook=_object,
            parse_int=_integer,
        )
    except UnicodeDecodeError as error:
        found = (
            "UTF-16, save it as UTF-8" if is_utf16(content) else f"not UTF-8 at byte {error.start}"
        )
        raise StrictJSONError([Fault("", found)]) from error
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise StrictJSONError([Fault("", f"not JSON: {error.msg} at {where}")]) from error
    faults = [fault for fault, _ in zip(_faults(document, ""), range(MAX_FAULTS), strict=False)]
    if faults:
        raise StrictJSONError(faults)
    return document


def canonical_json(value: Any) -> str:
    """Write JSON in the one form of RFC 8785, so that equal content has one hash.

    Keys sorted by UTF-16 code units, no white space, numbers as ECMAScript writes them.
    """
    return rfc8785.dumps(value).decode()


def build_pointer(*steps: str | int) -> str:
    """Return a JSON pointer (RFC 6901), escaping ``~`` and ``/``."""
    return "".join("/" + str(step).replace("~", "~0").replace("/", "~1") for step in steps)


def _depth(content: bytes) -> int:
    """Return the deepest nesting of brackets outside strings.

    A backslash outside a string is invalid JSON; the depth after one may come out too small.
    """
    unescaped = content.replace(rb"\\", b"").replace(rb"\"", b"")
    characters = np.frombuffer(unescaped, dtype=np.uint8)
    inside = np.logical_xor.accumulate(characters == _QUOTE)
    changes = _DEPTH_OF_BYTE[characters[~inside]]
    return int(np.cumsum(changes[changes != 0], dtype=np.int64).max(initial=0))


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    entries = dict(pairs)
    if len(entries) == len(pairs):
        return entries
    ambiguous = _ObjectWithDuplicates(entries)
    times = Counter(key for key, _ in pairs)
    ambiguous.duplicates = sorted(key for key, count in times.items() if count > 1)
    return ambiguous


def _integer(digits: str) -> int | float:
    """Parse an integer; one that is far too large becomes infinite, which is a fault later."""
    return int(digits) if len(digits) < 20 else math.inf


def _faults(value: Any, pointer: str) -> Iterator[Fault]:
    """Yield values that Python's parser accepts and other JSON readers do not."""
    if isinstance(value, list):
        for index, entry in enumerate(value):
            if not _is_plain_number(entry):
                yield from _faults(entry, f"{pointer}/{index}")
    elif isinstance(value, dict):
        yield from _faults_of_object(value, pointer)
    elif isinstance(value, str) and _has_lone_surrogate(value):
        yield Fault(pointer, "text with half a surrogate pair")
    elif isinstance(value, float) and not math.isfinite(value):
        yield Fault(pointer, "not a number that JSON or a double can hold")
    elif isinstance(value, int) and abs(value) > MAX_SAFE_INTEGER:
        yield Fault(pointer, f"integer {value} is beyond {MAX_SAFE_INTEGER}")


def _faults_of_object(entries: dict[str, Any], pointer: str) -> Iterator[Fault]:
    if isinstance(entries, _ObjectWithDuplicates):
        for key in entries.duplicates:
            yield Fault(pointer + build_pointer(key), "this key occurs twice")
    for key, entry in entries.items():
        if _has_lone_surrogate(key):
            yield Fault(pointer, "a key with half a surrogate pair")
        else:
            yield from _faults(entry, pointer + build_pointer(key))


def _is_plain_number(value: Any) -> bool:
    """Return whether a value is a number without fault: a fast path for long arrays of numbers."""
    if type(value) is float:
        return math.isfinite(value)
    return type(value) is int and -MAX_SAFE_INTEGER <= value <= MAX_SAFE_INTEGER


def _has_lone_surrogate(text: str) -> bool:
    return not text.isascii() and any("\ud800" <= character <= "\udfff" for character in text)
