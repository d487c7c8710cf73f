"""Routes of administration: the session, the audit log, the metrics for Prometheus."""

from __future__ import annotations

import shutil
from datetime import UTC, datetime
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from pydantic import AwareDatetime, Field

from app.api.http.page_files import prefix_of
from app.api.http.problems import problem_responses
from app.api.http.schemas.values import View
from app.api.middleware.access import COOKIE, cookie_of
from app.api.observation.metrics import MEDIA_TYPE
from app.api.services.identities import identity_of
from app.api.services.running_studio import Audit, CurrentStudio, Quotas, ServerSettings, SignIns
from app.store import Role
from app.store.audit import MOST_LISTED

router = APIRouter(tags=["administration"])

scraped = APIRouter()
"""Router of what is outside the API, where Prometheus looks for it."""


class QuotaView(View):
    """What somebody keeps, uploads under way included, and may keep."""

    clips: int
    most_clips: int
    """0 is any number."""
    bytes: int
    most_bytes: int
    """0 is any number."""


class SessionView(View):
    """Who sends this request."""

    name: str
    """Of the token; empty where the server needs none."""
    role: Role
    """read, edit or admin; each includes the ones before it."""
    signed_in: bool
    """Whether a cookie keeps the token, so that one can log out."""
    quota: QuotaView | None
    """null where nothing limits what the name keeps."""


@router.get("/session", responses=problem_responses())
def get_session(request: Request, quotas: Quotas) -> SessionView:
    """Return the name and the role of the token in use, and what is left of its quota."""
    identity = identity_of(request.scope)
    quota = None
    if identity.quota_bytes or identity.quota_clips:
        usage = quotas.usage(identity.name)
        quota = QuotaView(
            clips=usage.clips,
            most_clips=identity.quota_clips,
            bytes=usage.bytes,
            most_bytes=identity.quota_bytes,
        )
    return SessionView(
        name=identity.name,
        role=identity.role,
        signed_in=bool(identity.name) and COOKIE in request.cookies,
        quota=quota,
    )


@router.delete("/session", status_code=204, responses=problem_responses())
def end_session(request: Request, sign_ins: SignIns, settings: ServerSettings) -> Response:
    """Log out: the session ends on all servers, and its open streams with it."""
    if cookie := cookie_of(request.headers):
        sign_ins.end(cookie)
    response = Response(status_code=204)
    path = f"{prefix_of(request.headers, settings)}/"
    response.delete_cookie(COOKIE, path=path, httponly=True, samesite="strict")
    return response


Moment = Annotated[
    AwareDatetime, Field(ge=datetime(1970, 1, 1, tzinfo=UTC), lt=datetime(9000, 1, 1, tzinfo=UTC))
]
"""A moment with its offset from UTC, which every database knows."""


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


@router.get("/audit", responses=problem_responses())
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


@scraped.get("/metrics", include_in_schema=False)
def get_metrics(request: Request, studio: CurrentStudio) -> Response:
    """Return counts and gauges as text; only for the role admin where tokens are needed."""
    metrics = studio.metrics
    metrics.set("osg_jobs_open", "Jobs by status", studio.jobs.count_by_status())
    uploads = studio.uploads.active()
    metrics.set("osg_uploads_open", "Resumable uploads under way", {"": len(uploads)})
    missing = sum(upload.to_come for upload in uploads)
    metrics.set("osg_upload_bytes_to_come", "Bytes that they still announce", {"": missing})
    disk = shutil.disk_usage(studio.settings.data_dir)
    metrics.set("osg_disk_free_bytes", "Free space of the data folder's disk", {"": disk.free})
    metrics.set("osg_disk_total_bytes", "Size of that disk", {"": disk.total})
    connections = len(request.app.state.connections)
    metrics.set("osg_connections_open", "Open connections", {"": connections})
    return Response(metrics.write(), media_type=MEDIA_TYPE)
