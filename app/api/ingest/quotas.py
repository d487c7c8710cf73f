"""Quotas: how many clips, and bytes of them, one name may keep."""

from __future__ import annotations

import asyncio
from weakref import WeakValueDictionary

from fastapi import Request
from starlette.concurrency import run_in_threadpool

from app.api.http.problems import ProblemError
from app.api.middleware.identities import identity_of
from app.api.services.studio import Studio

CLOSE = {"Connection": "close"}
"""What is left of the body stays unread, so the connection cannot be used again."""


_turns: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()


def turn_of(request: Request, studio: Studio) -> asyncio.Lock:
    """Return the lock under which a name's quota is checked and then used.

    Without it, uploads that end at the same time would all be told that there is place for one.
    """
    return _turns.setdefault(f"{owner_of(request)}\n{studio.clips.folder}", asyncio.Lock())


def owner_of(request: Request) -> str:
    """Return the name that a quota counts by; empty where no token is needed."""
    return identity_of(request.scope).name


async def require_quota(
    request: Request, studio: Studio, size: int, *, without: str | None = None
) -> None:
    """Refuse a clip of so many bytes that its sender's quota has no place for.

    Uploads that are under way count with all their bytes; `without` is the id of the one that is
    about to become this clip.

    Raises
    ------
    ProblemError
        413 when the clip alone is larger than the quota, 507 when less than that is left, or as
        many clips are kept as may be.

    """
    identity = identity_of(request.scope)
    if not (identity.quota_bytes or identity.quota_clips):
        return
    clips, used = await run_in_threadpool(studio.clips.usage, identity.name)
    for upload in await run_in_threadpool(studio.uploads.active):
        if upload.owner == identity.name and upload.id != without:
            clips, used = clips + 1, used + upload.size
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
