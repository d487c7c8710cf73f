"""Routes of the session: who is signed in, and log-out."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.api.http.page_files import prefix_of
from app.api.http.problems import problem_responses
from app.api.http.schemas.values import View
from app.api.middleware.access import COOKIE, cookie_of
from app.api.services.identities import identity_of
from app.api.services.running_studio import Quotas, ServerSettings, SignIns
from app.store import Role

router = APIRouter(prefix="/session", tags=["administration"])


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


@router.get("", responses=problem_responses())
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


@router.delete("", status_code=204, responses=problem_responses())
def end_session(request: Request, sign_ins: SignIns, settings: ServerSettings) -> Response:
    """Log out: the session ends on all servers, and its open streams with it."""
    if cookie := cookie_of(request.headers):
        sign_ins.end(cookie)
    response = Response(status_code=204)
    path = f"{prefix_of(request.headers, settings)}/"
    response.delete_cookie(COOKIE, path=path, httponly=True, samesite="strict")
    return response
