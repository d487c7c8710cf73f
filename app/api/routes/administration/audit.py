"""Route of the audit log, for administrators."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Query
from pydantic import BaseModel, ConfigDict, Field

from app.api.http.problems import problem_responses
from app.api.services.studio import CurrentStudio
from app.store.audit import MOST_LISTED

router = APIRouter(prefix="/audit", tags=["administration"])


class AuditView(BaseModel):
    """One change."""

    model_config = ConfigDict(from_attributes=True)

    id: int
    time: datetime
    name: str = Field(description="Of the token; empty where the server needs none")
    role: str
    address: str = Field(description="Of the client, or as a trusted proxy says")
    method: str
    path: str = Field(description="What was changed")
    status: int = Field(description="What was answered")
    request_id: str = Field(description="The same as in the log")


@router.get("", responses=problem_responses())
def list_audit(
    studio: CurrentStudio,
    limit: Annotated[int, Query(ge=1, le=MOST_LISTED)] = 100,
    before: Annotated[
        int | None, Query(ge=1, le=2**31 - 1, description="Only smaller ids: the next page")
    ] = None,
    name: Annotated[str | None, Query(max_length=80, description="Only of this name")] = None,
) -> list[AuditView]:
    """List changes, the newest first; only for the role admin where tokens are needed."""
    entries = studio.audit.newest(limit, before=before, name=name)
    return [AuditView.model_validate(entry) for entry in entries]
