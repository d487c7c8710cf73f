"""Workspaces: open one per browser tab, and tell it what to show."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from fastapi import APIRouter, HTTPException, Path, Response
from pydantic import BaseModel, ConfigDict, Field

from app.recognition.errors import OsgError
from app.ui.workspace import Workspace, WorkspaceView
from app.ui.workspace_registry import TooManyWorkspacesError, WorkspaceRegistry

WorkspaceId = Annotated[str, Path(max_length=64, pattern="^[A-Za-z0-9_-]+$")]


class WorkspaceOptions(BaseModel):
    """How a workspace looks."""

    model_config = ConfigDict(extra="forbid")

    dark: bool = True
    """Dark colours rather than light ones."""


class OpenedWorkspace(BaseModel):
    """A workspace and where its viser page lies."""

    id: str
    url: str


class ViewRequest(BaseModel):
    """What a workspace is to show."""

    model_config = ConfigDict(extra="forbid")

    clip_id: Annotated[str, Field(max_length=64)]
    recognition_id: Annotated[str | None, Field(max_length=64)] = None
    language_id: Annotated[str | None, Field(max_length=64)] = None
    start: Annotated[float | None, Field(ge=0, allow_inf_nan=False)] = None
    end: Annotated[float | None, Field(ge=0, allow_inf_nan=False)] = None


def router(
    registry: WorkspaceRegistry, view_of: Callable[[ViewRequest], WorkspaceView]
) -> APIRouter:
    """Make the routes under ``/workspaces``.

    Parameters
    ----------
    registry
        The open workspaces.
    view_of
        Looks up what is to be shown, and raises the errors of its own for what is not there.
        Called in a thread.

    """
    routes = APIRouter(prefix="/workspaces", tags=["workspaces"])

    @routes.post("", status_code=201)
    def open_workspace(options: WorkspaceOptions | None = None) -> OpenedWorkspace:
        """Open a workspace for one browser tab."""
        try:
            workspace = registry.create(dark=(options or WorkspaceOptions()).dark)
        except TooManyWorkspacesError as error:
            raise HTTPException(503, str(error), headers={"Retry-After": "30"}) from error
        return OpenedWorkspace(id=workspace.id, url=f"/viser/{workspace.id}/")

    @routes.get("/{workspace_id}")
    def find_workspace(workspace_id: WorkspaceId) -> OpenedWorkspace:
        """Tell whether a workspace is still open."""
        workspace = _found(registry, workspace_id)
        return OpenedWorkspace(id=workspace.id, url=f"/viser/{workspace.id}/")

    @routes.patch("/{workspace_id}", status_code=204)
    def change_workspace(workspace_id: WorkspaceId, options: WorkspaceOptions) -> Response:
        """Change how a workspace looks."""
        _found(registry, workspace_id).set_dark(options.dark)
        return Response(status_code=204)

    @routes.put("/{workspace_id}/view", status_code=204)
    def show_view(workspace_id: WorkspaceId, request: ViewRequest) -> Response:
        """Show a clip, a range of it, or a recognition."""
        workspace = _found(registry, workspace_id)
        view = view_of(request)
        try:
            workspace.show(view)
        except OsgError as error:
            raise HTTPException(422, str(error)) from error
        return Response(status_code=204)

    @routes.delete("/{workspace_id}", status_code=204)
    def close_workspace(workspace_id: WorkspaceId) -> Response:
        """Close a workspace."""
        _found(registry, workspace_id)
        registry.remove(workspace_id)
        return Response(status_code=204)

    return routes


def _found(registry: WorkspaceRegistry, workspace_id: str) -> Workspace:
    workspace = registry.get(workspace_id)
    if workspace is None:
        raise HTTPException(404, "There is no such workspace; reload the page to open one.")
    return workspace
