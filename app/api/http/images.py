"""JPEG responses: an image that a job has written, or 404 until then."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from fastapi import Response

from app.api.http.problems import ProblemError

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
