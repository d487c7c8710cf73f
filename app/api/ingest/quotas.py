"""Quotas: how many clips, and bytes of them, one name may keep."""

from __future__ import annotations

from functools import partial

from fastapi import Request
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import ProblemError
from app.api.middleware.identities import Identity, identity_of
from app.api.services.running_studio import Studio
from app.store import Allowance, Usage

CLOSE = {"Connection": "close"}
"""The rest of the body stays unread, so the connection cannot be reused."""


def owner_of(request: Request) -> str:
    """Return the name to which a quota applies; empty if no token is needed."""
    return identity_of(request.scope).name


async def require_quota(request: Request, studio: Studio, size: int) -> None:
    """Refuse, early, a clip of at least `size` bytes that exceeds its sender's quota.

    The quota is checked again when the clip or its upload is stored.

    Raises
    ------
    ProblemError
        As `allowance_of`.

    """
    if (allow := allowance_of(request, size)) is not None:
        allow(await run_in_threadpool(studio.quotas.usage, owner_of(request)))


def allowance_of(request: Request, size: int) -> Allowance | None:
    """Return the check of a clip of `size` bytes against its sender's quota; None without a quota.

    It raises ProblemError: 413 when the clip alone exceeds the quota, 507 when too little of the
    quota is left or the owner keeps the most clips allowed. Uploads under way count with all their
    bytes.
    """
    identity = identity_of(request.scope)
    if not (identity.quota_bytes or identity.quota_clips):
        return None
    return partial(_require_place, identity, size)


def _require_place(identity: Identity, size: int, usage: Usage) -> None:
    clips, used = usage.clips, usage.bytes
    numbers = {"clips": clips, "bytes": used}
    if identity.quota_clips and clips >= identity.quota_clips:
        detail = (
            f"{identity.name!r} keeps {clips} clips, and {identity.quota_clips} are allowed; "
            "delete some, or ask an administrator for a larger quota"
        )
        raise _exceeded(detail, numbers, limit=identity.quota_clips)
    if identity.quota_bytes and size > identity.quota_bytes:
        detail = (
            f"this clip has {_megabytes(size)}, and {identity.name!r} may keep "
            f"{_megabytes(identity.quota_bytes)} in all; send a shorter or smaller clip"
        )
        raise ProblemError(
            413,
            "quota_exceeded",
            detail,
            headers=CLOSE,
            used=numbers,
            limit=identity.quota_bytes,
        )
    if identity.quota_bytes and used + size > identity.quota_bytes:
        left = max(0, identity.quota_bytes - used)
        detail = (
            f"{identity.name!r} keeps {_megabytes(used)} of clips, so {_megabytes(left)} are left "
            f"for this one of {_megabytes(size)}; delete clips, or ask for a larger quota"
        )
        raise _exceeded(detail, numbers, limit=identity.quota_bytes)


def _exceeded(detail: str, used: dict[str, int], limit: int) -> ProblemError:
    return ProblemError(507, "quota_exceeded", detail, headers=CLOSE, used=used, limit=limit)


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.1f} MB"
