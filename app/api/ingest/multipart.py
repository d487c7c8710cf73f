"""Multipart parser: streams one uploaded file to disk."""

from __future__ import annotations

import shutil
import unicodedata
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header
from starlette.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect, Request

from app.api.http.problems import ProblemError
from app.api.ingest.fields import LONGEST, UploadFields
from app.api.middleware.request_bodies import stated_bytes, too_large
from app.settings import Settings

FRAME_BYTES = 64 * 1024
"""Most bytes of the multipart framing around the file: a few headers and small fields."""

MOST_PARTS = 16
"""Most parts of one form; the page sends one."""

LONGEST_NAME = 200
"""Characters of a file name that are shown and kept."""

_FLUSH_BYTES = 1024 * 1024


@dataclass(frozen=True)
class Upload:
    """A file that arrived.

    Attributes
    ----------
    name
        Name to show; see `display_name`.
    size
        Bytes.
    fields
        Values of the form's other fields.

    """

    name: str
    size: int
    fields: UploadFields


def file_form(**properties: Any) -> dict[str, Any]:
    """Return the ``openapi_extra`` of a route that takes a form with a file and more."""
    schema = {
        "type": "object",
        "required": ["file"],
        "properties": {"file": {"type": "string", "format": "binary"}, **properties},
    }
    content = {"multipart/form-data": {"schema": schema}}
    return {"requestBody": {"required": True, "content": content}}


async def receive_file(
    request: Request, target: Path, settings: Settings, *, reserved: int = 0
) -> Upload:
    """Write the form's part ``file`` to `target`; `reserved` as in `require_space`.

    Memory stays at about a megabyte. After an error the caller must remove `target`.

    Raises
    ------
    ProblemError
        400 when the form is malformed or cut short, 408 when it comes too slowly, 413 when the file
        is too large, 415 when the body is no multipart form, 422 when a field has an invalid value,
        507 when the disk is too full.

    """
    require_space(target.parent, stated_bytes(request.headers), settings, reserved=reserved)
    parser = _file_part(request, settings)
    with await run_in_threadpool(target.open, "wb") as file:
        try:
            async for chunk in request.stream():
                parser.feed(chunk)
                if len(parser.pending) >= _FLUSH_BYTES:
                    await _flush(parser, file)
        except FormParserError as error:
            raise _malformed(f"the form is not valid multipart: {error}") from error
        except ClientDisconnect as error:
            raise _malformed("the upload was broken off") from error
        await _flush(parser, file)
    return parser.finished()


async def receive_body(request: Request, target: Path, settings: Settings) -> int:
    """Write a whole body to `target`, and return its size; see `receive_file`."""
    require_space(target.parent, stated_bytes(request.headers), settings)
    size = 0
    with await run_in_threadpool(target.open, "wb") as file:
        try:
            async for chunk in request.stream():
                size += len(chunk)
                await run_in_threadpool(file.write, chunk)
        except ClientDisconnect as error:
            raise _malformed("the upload was broken off") from error
    return size


def least_size(request: Request) -> int:
    """Return the bytes that the file of a form has at least, by the stated length of the body."""
    return max(0, stated_bytes(request.headers) - FRAME_BYTES)


def display_name(name: str) -> str:
    """Return the name to show for a file that its sender calls `name`.

    Folders, control characters and marks that change the writing direction are removed, and a name
    that is too long is cut before its ending.
    """
    base = name.replace("\\", "/").rsplit("/", 1)[-1]
    visible = "".join(
        character for character in base if not unicodedata.category(character).startswith("C")
    )
    visible = " ".join(visible.split())
    if len(visible) > LONGEST_NAME:
        stem, dot, ending = visible.rpartition(".")
        ending = f"{dot}{ending}" if stem and len(ending) <= 8 else ""
        visible = visible[: LONGEST_NAME - 1 - len(ending)] + "…" + ending
    return visible or "clip"


class _FilePart:
    """Extracts the bytes of the part ``file``, and the other fields, from a multipart body."""

    def __init__(self, boundary: bytes, limit: int) -> None:
        self.pending = bytearray()
        """Bytes of the file that are not yet written."""
        self._limit = limit
        self._size = 0
        self._parts = 0
        self._name: str | None = None
        self._in_file = False
        self._field: str | None = None
        self._fields: dict[str, bytearray] = {}
        self._ended = False
        self._header = bytearray()
        self._value = bytearray()
        self._disposition = b""
        self._parser = MultipartParser(
            boundary,
            {
                "on_part_begin": self._on_part_begin,
                "on_header_field": self._on_header_field,
                "on_header_value": self._on_header_value,
                "on_header_end": self._on_header_end,
                "on_headers_finished": self._on_headers_finished,
                "on_part_data": self._on_part_data,
                "on_end": self._on_end,
            },
        )

    def feed(self, chunk: bytes) -> None:
        self._parser.write(chunk)

    def finished(self) -> Upload:
        if not self._ended:
            raise _malformed("the form ends before its last boundary; send the clip again")
        if self._name is None:
            raise _malformed("the form has no part named 'file' with a file name; send one clip")
        texts = {name: text.decode("utf-8", "replace") for name, text in self._fields.items()}
        return Upload(display_name(self._name), self._size, UploadFields.read(texts))

    def _on_part_begin(self) -> None:
        self._parts += 1
        if self._parts > MOST_PARTS:
            raise _malformed(f"the form has more than {MOST_PARTS} parts; send one clip")
        self._disposition = b""
        self._in_file, self._field = False, None

    def _on_header_field(self, data: bytes, start: int, end: int) -> None:
        self._header += data[start:end]

    def _on_header_value(self, data: bytes, start: int, end: int) -> None:
        self._value += data[start:end]

    def _on_header_end(self) -> None:
        if bytes(self._header).lower() == b"content-disposition":
            self._disposition = bytes(self._value)
        self._header.clear()
        self._value.clear()

    def _on_headers_finished(self) -> None:
        _, options = parse_options_header(self._disposition)
        name = options.get(b"name", b"").decode("utf-8", "replace")
        if name in LONGEST and b"filename" not in options:
            self._field, self._fields[name] = name, bytearray()
        if name != "file" or b"filename" not in options:
            return
        if self._name is not None:
            raise _malformed("the form has several parts named 'file'; send one clip at a time")
        self._in_file = True
        self._name = options[b"filename"].decode("utf-8", "replace")

    def _on_part_data(self, data: bytes, start: int, end: int) -> None:
        if self._field is not None:
            text, most = self._fields[self._field], LONGEST[self._field]
            text += data[start:end]
            if len(text) > most:
                raise _malformed(f"the field {self._field!r} is longer than {most} bytes")
        if not self._in_file:
            return
        self._size += end - start
        if self._size > self._limit:
            raise too_large(self._limit)
        self.pending += data[start:end]

    def _on_end(self) -> None:
        self._ended = True


def _file_part(request: Request, settings: Settings) -> _FilePart:
    kind, options = parse_options_header(request.headers.get("content-type", ""))
    if kind != b"multipart/form-data":
        raise ProblemError(
            415,
            "unsupported_media_type",
            "the clip must be sent as multipart/form-data with a part named 'file'",
        )
    if not (boundary := options.get(b"boundary")):
        raise _malformed("the Content-Type header names no boundary")
    try:
        return _FilePart(boundary, settings.max_clip_bytes)
    except FormParserError as error:
        raise _malformed(f"the form is not valid multipart: {error}") from error


async def _flush(parser: _FilePart, file: BinaryIO) -> None:
    data = bytes(parser.pending)
    parser.pending.clear()
    await run_in_threadpool(file.write, data)


def require_space(folder: Path, size: int, settings: Settings, *, reserved: int = 0) -> None:
    """Refuse a file of `size` bytes that would leave too little space on the disk of `folder`.

    `reserved` is the number of bytes that other uploads have announced and not yet sent.
    """
    needed = size + reserved + settings.limits.free_disk_bytes
    free = shutil.disk_usage(folder).free
    if free < needed:
        announced = f", {reserved / 1e6:.0f} MB of it for uploads under way" if reserved else ""
        raise ProblemError(
            507,
            "disk_full",
            f"the server has {free / 1e6:.0f} MB of disk left and needs {needed / 1e6:.0f} MB for "
            f"this{announced}; delete clips or free space, then try again",
            headers={"Retry-After": "60", "Connection": "close"},
        )


def _malformed(detail: str) -> ProblemError:
    return ProblemError(400, "malformed_upload", detail, headers={"Connection": "close"})
