"""Route of the audit log, for administrators."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated

from fastapi import APIRouter, Query
from pydantic import AwareDatetime, Field

from app.api.http.problems import problem_responses
from app.api.http.schemas.values import View
from app.api.services.running_studio import Audit
from app.store.audit import MOST_LISTED

Moment = Annotated[
    AwareDatetime, Field(ge=datetime(1970, 1, 1, tzinfo=UTC), lt=datetime(9000, 1, 1, tzinfo=UTC))
]
"""A moment with its offset from UTC, which every database knows."""

router = APIRouter(prefix="/audit", tags=["administration"])


class AuditView(View):
    """One change."""

    id: int
    time: datetime
    name: str
    """Of the token; empty where the server needs none; `command line` of a command."""
    role: str
    address: str
    """Of the client, or as a trusted proxy says."""
    method: str
    """Of the request; or the command, such as `tokens add`."""
    path: str
    """What was changed, or what the command was given."""
    status: int
    """What was answered; 0 of a command."""
    request_id: str
    """The same as in the log."""


@router.get("", responses=problem_responses())
def list_audit(
    audit: Audit,
    limit: Annotated[int, Query(ge=1, le=MOST_LISTED)] = 100,
    before: Annotated[
        int | None, Query(ge=1, le=2**31 - 1, description="Only smaller ids: the next page")
    ] = None,
    name: Annotated[str | None, Query(max_length=80, description="Only of this name")] = None,
    since: Annotated[Moment | None, Query(description="Only from this moment on")] = None,
    until: Annotated[Moment | None, Query(description="Only before this moment")] = None,
) -> list[AuditView]:
    """List changes, the newest first; only for the role admin where tokens are needed."""
    entries = audit.newest(limit, before=before, name=name, since=since, until=until)
    return [AuditView.model_validate(entry) for entry in entries]
