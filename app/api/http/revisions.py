"""Revision numbers in requests and answers: the query parameter, ``If-Match`` and ``ETag``."""

from __future__ import annotations

import re
from typing import Annotated

from fastapi import Depends, Header, Query

from app.api.http.problems import ProblemError

_REVISION_TAG = re.compile(r'(?:W/)?"(\d{1,9})"', re.ASCII)

Revision = Annotated[int | None, Query(ge=0, le=2**31 - 1)]


def _expected_revision(
    if_match: Annotated[
        str | None, Header(description="The ETag of the revision that the change was made from")
    ] = None,
) -> int | None:
    if if_match is None or if_match.strip() == "*":
        return None
    if match := _REVISION_TAG.fullmatch(if_match.strip()):
        return int(match[1])
    detail = f"If-Match {if_match[:80]!r} names no revision; send the ETag of the language"
    raise ProblemError(412, "revision_conflict", detail)


ExpectedRevision = Annotated[int | None, Depends(_expected_revision)]
"""The revision that the caller changes, from ``If-Match``; None accepts the newest one."""


def revision_tag(revision: int) -> str:
    """Return the ETag of a revision."""
    return f'"{revision}"'
