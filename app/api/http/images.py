"""JPEG responses: an image that a job has written, or 404 until then."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fastapi import Request
from fastapi.responses import FileResponse

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.ranges import keep_single_range


def picture_responses(description: str) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI ``responses`` of a route that answers with `send_picture`."""
    return {
        **problem_responses(404, 416),
        200: {"description": description, "content": {"image/jpeg": {}}},
    }


def send_picture(request: Request, path: Path, code: str, missing: str) -> FileResponse:
    """Return the JPEG at `path`.

    Raises
    ------
    ProblemError
        404 with `code` and `missing` as its detail while the job has not written it.

    """
    if not path.is_file():
        raise ProblemError(404, code, missing)
    keep_single_range(request, path.stat().st_size)
    headers = {"Cache-Control": "private, max-age=3600"}
    return FileResponse(path, media_type="image/jpeg", headers=headers)
