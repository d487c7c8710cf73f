"""Range requests: one range per request, all other forms are ignored."""

from __future__ import annotations

import re

from fastapi import Request

from app.api.http.problems import ProblemError

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
