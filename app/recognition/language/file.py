"""Language file: strict reading, deterministic writing, and the SHA-256 seal."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from app.recognition.errors import LanguageError
from app.recognition.language.file_schema import (
    FORMAT,
    MAX_FILE_BYTES,
    MAX_GESTURES,
    VERSION,
    LanguageDocument,
)
from app.recognition.text.strict_json import (
    MAX_FAULTS,
    Fault,
    StrictJSONError,
    build_pointer,
    canonical_json,
    read_json,
)

_LISTED = frozenset({"gestures", "phrases", "slot_types"})
"""Keys whose entries are written one per line."""


def write_document(document: LanguageDocument) -> str:
    """Return the text of a document with its seal, one line per key, gesture and phrase.

    The lines keep diffs between revisions readable.
    """
    content = document.model_dump(mode="json", exclude={"sha256"}, exclude_defaults=True)
    content["sha256"] = seal(content)
    lines = ",\n".join(f"{_compact(key)}: {_value(key, value)}" for key, value in content.items())
    return f"{{\n{lines}\n}}\n"


def read_content(path: str | Path) -> bytes:
    """Read a file up to one byte more than the largest language file.

    Raises
    ------
    LanguageError
        When it cannot be read.

    """
    try:
        with Path(path).open("rb") as file:
            # One byte more than allowed is enough to detect a file that is too large.
            return file.read(MAX_FILE_BYTES + 1)
    except OSError as error:
        raise LanguageError(f"cannot read {path}: {error.strerror}") from error


@contextmanager
def name_file(path: str | Path) -> Iterator[None]:
    """Put the file's name before the message of a `LanguageError`; its pointer stays."""
    try:
        yield
    except LanguageError as error:
        named = LanguageError(f"{Path(path).name}: {error}")
        named.pointer = error.pointer
        raise named from error


def read_document(text: str | bytes) -> LanguageDocument:
    """Read a language file's text and validate it against the schema.

    Raises
    ------
    LanguageError
        When it is no language file of this version, violates the schema, or does not match its
        seal.

    """
    content = text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text
    try:
        read = read_json(content, MAX_FILE_BYTES)
    except StrictJSONError as error:
        raise _language_error(error.faults) from error
    _check_kind(read)
    try:
        document = LanguageDocument.model_validate(read)
    except ValidationError as error:
        raise _language_error(_faults(error)) from error
    if document.sha256 is not None and document.sha256 != seal(read):
        raise LanguageError(
            "the content does not match this seal: the file was damaged, or edited by hand. If "
            'the edit was meant, remove the line "sha256" and save again with osg-studio convert',
            "/sha256",
        )
    return document


def seal(content: dict[str, Any]) -> str:
    """Return the SHA-256 of the canonical JSON of everything but ``sha256``, in hexadecimal."""
    sealed = {key: value for key, value in content.items() if key != "sha256"}
    return hashlib.sha256(canonical_json(sealed).encode("utf-8")).hexdigest()


def _check_kind(read: Any) -> None:
    """Refuse other files and versions with one clear message, before validating the schema."""
    if not isinstance(read, dict) or read.get("format") != FORMAT:
        raise LanguageError(
            f'not a language file: its "format" must be "{FORMAT}". A file of the published '
            "implementation can be brought in with osg-studio convert",
            "/format" if isinstance(read, dict) else "",
        )
    version = read.get("version")
    if isinstance(version, bool):  # which Python takes for 0 or 1
        raise LanguageError(f"must be a number, got {version}", "/version")
    if isinstance(version, int) and version > VERSION:
        raise LanguageError(
            f"version {version} is newer than this program reads ({VERSION}): update osg-studio",
            "/version",
        )
    gestures = read.get("gestures")
    if isinstance(gestures, list) and len(gestures) > MAX_GESTURES:
        raise LanguageError(f"{len(gestures)} gestures, the limit is {MAX_GESTURES}", "/gestures")


def _faults(error: ValidationError) -> list[Fault]:
    return [
        Fault(build_pointer(*list_document_steps(fault["loc"])), fault["msg"])
        for fault in error.errors(include_url=False, include_context=False, include_input=False)
    ]


def list_document_steps(location: tuple[int | str, ...]) -> tuple[int | str, ...]:
    """Return the place of a pydantic error in the document, without the branches of unions."""
    branches = {
        *("constrained-str", "str", "int", "float", "dict[str,any]", "constrained-float"),
        *("gestures-part", "slot-part", "group-part"),
    }
    return tuple(step for step in location if step not in branches)


def _language_error(faults: list[Fault]) -> LanguageError:
    """Return one error for several faults, with the first pointer and all messages in one line."""
    first, *others = faults[:MAX_FAULTS]
    message = first.message + "".join(f"; {fault.pointer}: {fault.message}" for fault in others)
    if len(faults) > MAX_FAULTS:
        message += f"; and {len(faults) - MAX_FAULTS} more"
    return LanguageError(message, first.pointer)


def _value(key: str, value: Any) -> str:
    if key in _LISTED and value:
        return "[\n" + ",\n".join(_compact(entry) for entry in value) + "\n]"
    if key == "grammar":
        members = (f"{_compact(name)}: {_value(name, each)}" for name, each in value.items())
        return "{\n" + ",\n".join(members) + "\n}"
    return _compact(value)


def _compact(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


DIGITS = 8
"""Hexadecimal digits: two languages of a team have the same code once in four thousand million."""


def short_code(sha256: str) -> str:
    """Return the code of a language file's checksum, such as ``7F3A-91C2``.

    Parameters
    ----------
    sha256
        The `sha256` of the file, in hexadecimal.

    """
    digits = sha256[:DIGITS].upper()
    return f"{digits[: DIGITS // 2]}-{digits[DIGITS // 2 :]}"
