"""Files in answers: the names under which browsers save them, their ranges, pictures of jobs."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path
from typing import Final
from urllib.parse import quote

from fastapi import Request, Response

from app.api.http.problems import ProblemError


def attachment(name: str, suffix: str) -> str:
    """Return the ``Content-Disposition`` of a file whose name a shell takes without quotes.

    The page writes the same name into the robot's command (``fileName`` of the page's
    `export/export-dialog.js`); who calls this chooses `name`.
    """
    plain = "".join(
        each for each in unicodedata.normalize("NFKD", name) if unicodedata.category(each)[0] != "M"
    )
    stem = re.sub(r"[^\w.-]+", "-", plain, flags=re.ASCII).strip("-") or "language"
    return f'attachment; filename="{stem}{suffix}"'


def attachment_as_written(name: str, plain: str) -> str:
    """Return that of a file under any name; `plain` is for clients that know ASCII alone."""
    return f"attachment; filename=\"{plain}\"; filename*=utf-8''{quote(name, safe='')}"


JPEG: Final = "image/jpeg"
"""Media type of `send_picture`."""


def send_picture(path: Path, code: str, missing: str) -> Response:
    """Return the JPEG at `path`, of some ten kilobytes.

    Read at once, because a job may replace it: its length would be that of the one before.

    Raises
    ------
    ProblemError
        404 with `code` and `missing` as its detail while the job has not written it.

    """
    try:
        content = path.read_bytes()
    except FileNotFoundError as error:
        raise ProblemError(404, code, missing) from error
    headers = {"Cache-Control": "private, max-age=3600"}
    return Response(content, media_type=JPEG, headers=headers)


_SINGLE_RANGE = re.compile(r"bytes=(\d{1,18})-(\d{0,18})|bytes=-(\d{1,18})", re.ASCII)


def keep_single_range(request: Request, size: int) -> None:
    """Keep a single well-formed range in the request, and remove all other forms.

    A server may ignore ranges (RFC 9110, 14.2), so that a header of ten thousand ranges costs
    nothing.

    Raises
    ------
    ProblemError
        416 when the range begins behind the file's end.

    """
    header = request.headers.get("range")
    match = _SINGLE_RANGE.fullmatch(header.strip()) if header else None
    start, end, suffix = match.groups() if match else (None, None, None)
    reversed_range = bool(start and end) and int(end or 0) < int(start or 0)
    if match is None or reversed_range:
        scope = request.scope
        scope["headers"] = [pair for pair in scope["headers"] if pair[0].lower() != b"range"]
        return
    if (start is not None and int(start) >= size) or (suffix is not None and int(suffix) == 0):
        raise ProblemError(
            416,
            "range_not_satisfiable",
            f"the range {header!r} lies outside the {size} bytes of this file",
            headers={"Content-Range": f"bytes */{size}"},
        )
