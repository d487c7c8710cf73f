"""Routes of workspaces: open one per browser tab, set what it shows, close it."""

from __future__ import annotations

from http import HTTPStatus
from typing import Final

from fastapi import APIRouter, Response
from pydantic import StrictBool

from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.values import Body, View
from app.api.services.running_studio import CurrentStudio
from app.api.viser_workspaces.view_requests import ViewRequest, view_of
from app.api.viser_workspaces.workspace_lookup import CurrentWorkspace, CurrentWorkspaces, Owner
from app.recognition.errors import OsgError
from app.ui.workspace_registry import TooManyWorkspacesError

UNSHOWABLE: Final = HTTPStatus(422).name.lower()
"""Code of the problem for a range without anything to show."""


class WorkspaceOptions(Body):
    """How a workspace looks."""

    dark: StrictBool = True
    """Dark colours rather than light ones."""
    flat: StrictBool = True
    """The picture square to the camera rather than the space-time cube."""
    animate: StrictBool = True
    """Move between the two, for people who do not mind moving pictures."""


class OpenedWorkspace(View):
    """A workspace and where its viser page lies."""

    id: str
    url: str


router = APIRouter(prefix="/workspaces", tags=["workspaces"], responses=problem_responses(404))


@router.post("", status_code=201)
def open_workspace(
    workspaces: CurrentWorkspaces, owner: Owner, options: WorkspaceOptions | None = None
) -> OpenedWorkspace:
    """Open a workspace for one browser tab."""
    try:
        workspace = workspaces.create(owner=owner, dark=(options or WorkspaceOptions()).dark)
    except TooManyWorkspacesError as error:
        headers = {"Retry-After": "30"}
        raise ProblemError(503, "service_unavailable", str(error), headers=headers) from error
    return OpenedWorkspace(id=workspace.id, url=f"/viser/{workspace.id}/")


@router.get("/{workspace_id}")
def find_workspace(workspace: CurrentWorkspace) -> OpenedWorkspace:
    """Return whether a workspace is still open."""
    return OpenedWorkspace(id=workspace.id, url=f"/viser/{workspace.id}/")


@router.patch("/{workspace_id}", status_code=204)
def change_workspace(options: WorkspaceOptions, workspace: CurrentWorkspace) -> Response:
    """Change how a workspace looks; what is left out stays."""
    if "dark" in options.model_fields_set:
        workspace.set_dark(options.dark)
    if "flat" in options.model_fields_set:
        workspace.set_flat(options.flat, animate=options.animate)
    return Response(status_code=204)


@router.put("/{workspace_id}/view", status_code=204)
def show_view(request: ViewRequest, workspace: CurrentWorkspace, studio: CurrentStudio) -> Response:
    """Show a clip, a range of it, or a recognition."""
    view = view_of(studio, request)
    try:
        workspace.show(view, keep_frame=request.keep_frame)
    except OsgError as error:
        raise ProblemError(422, UNSHOWABLE, str(error)) from error
    return Response(status_code=204)


@router.delete("/{workspace_id}", status_code=204)
def close_workspace(workspace: CurrentWorkspace, workspaces: CurrentWorkspaces) -> Response:
    """Close a workspace."""
    workspaces.remove(workspace.id)
    return Response(status_code=204)
