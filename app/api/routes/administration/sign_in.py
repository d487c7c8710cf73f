"""Routes of the session: who is signed in, and log-out."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, Field

from app.api.http.problems import problem_responses
from app.api.middleware.access import COOKIE
from app.api.middleware.identities import identity_of
from app.store import Role

router = APIRouter(prefix="/session", tags=["administration"])


class SessionView(BaseModel):
    """Who sends this request."""

    name: str = Field(description="Of the token; empty where the server needs none")
    role: Role = Field(description="read, edit or admin; each includes the ones before it")
    signed_in: bool = Field(description="Whether a cookie keeps the token, so that one can log out")


@router.get("", responses=problem_responses())
def get_session(request: Request) -> SessionView:
    """Return the name and the role of the token in use."""
    identity = identity_of(request.scope)
    signed_in = bool(identity.name) and COOKIE in request.cookies
    return SessionView(name=identity.name, role=identity.role, signed_in=signed_in)


@router.delete("", status_code=204, responses=problem_responses())
def end_session() -> Response:
    """Log out: the browser forgets the cookie that keeps the token."""
    response = Response(status_code=204)
    response.delete_cookie(COOKIE, httponly=True, samesite="strict")
    return response
