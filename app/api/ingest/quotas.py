"""Quotas of requests: what their sender may keep."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Request
from starlette.concurrency import run_in_threadpool

from app.api.services.identities import identity_of
from app.api.services.running_studio import Studio
from app.store import Quota


def quota_of(request: Request) -> Quota:
    """Return the quota of a request's sender; nothing limits it if no token is needed."""
    identity = identity_of(request.scope)
    return Quota(identity.name, identity.quota_bytes, identity.quota_clips)


SenderQuota = Annotated[Quota, Depends(quota_of)]
"""Type of a route's parameter that receives the quota of the request's sender."""


async def require_quota(quota: Quota, studio: Studio, size: int) -> None:
    """Refuse, early, a clip of at least `size` bytes that exceeds its sender's quota.

    The quota is checked again when the clip or its upload is stored.

    Raises
    ------
    QuotaExceeded
        When it does not fit, even if what the sender deleted is purged.

    """
    if quota.bytes or quota.clips:
        kept = await run_in_threadpool(studio.quotas.usage, quota.owner, deleted=False)
        quota.require(kept, size, clips=1)
