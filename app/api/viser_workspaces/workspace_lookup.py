"""Workspace lookup: the registry of open workspaces as a dependency of routes, and search by id."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Path
from starlette.requests import HTTPConnection

from app.api.http.problems import ProblemError
from app.api.services.identities import identity_of
from app.ui.workspace import Workspace
from app.ui.workspace_registry import WorkspaceRegistry


def _registry_of(connection: HTTPConnection) -> WorkspaceRegistry:
    registry: WorkspaceRegistry = connection.app.state.workspaces
    return registry


def _name_of(connection: HTTPConnection) -> str:
    return identity_of(connection.scope).name


Owner = Annotated[str, Depends(_name_of)]
"""Type of a route's parameter that receives the sender's name, whose workspaces alone exist."""

CurrentWorkspaces = Annotated[WorkspaceRegistry, Depends(_registry_of)]
"""Type of a route's parameter that receives the open workspaces."""


def no_workspace() -> ProblemError:
    """Return the problem for an id that no open workspace has."""
    detail = "There is no such workspace; reload the page to open one."
    return ProblemError(404, "not_found", detail)


def _find(
    workspace_id: Annotated[str, Path(max_length=64, pattern="^[A-Za-z0-9_-]+$")],
    workspaces: CurrentWorkspaces,
    owner: Owner,
) -> Workspace:
    if (workspace := workspaces.get(workspace_id, owner)) is None:
        raise no_workspace()
    return workspace


CurrentWorkspace = Annotated[Workspace, Depends(_find)]
"""Type of a route's parameter that receives the sender's workspace of the address; 404 if none."""
