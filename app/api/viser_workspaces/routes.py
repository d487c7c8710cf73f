"""Routes of workspaces: open one per browser tab, set what it shows, play it, close it."""

from __future__ import annotations

import asyncio
import contextlib
from dataclasses import asdict
from http import HTTPStatus
from typing import Annotated, Final, Literal

from fastapi import APIRouter, Depends, Path, Response, WebSocket
from pydantic import Field, StrictBool, TypeAdapter, ValidationError
from starlette.requests import HTTPConnection

from app.api.events.broadcast import Unread
from app.api.http.problems import ProblemError, problem_responses
from app.api.http.schemas.values import Body, View
from app.api.http.websockets import (
    POLICY_VIOLATION,
    UNSUPPORTED_DATA,
    same_origin,
    until_one_ends,
)
from app.api.services.identities import identity_of
from app.api.services.recording_cache import recording_of
from app.api.services.running_studio import CurrentStudio, Studio
from app.api.services.stored_languages import language_of
from app.api.services.stored_recognitions import load_recognition, try_gesture, view_recognition
from app.recognition import Language
from app.recognition.errors import OsgError
from app.store import RecognitionRecord
from app.ui.playback import Playback, Position
from app.ui.workspace import Workspace, WorkspaceView
from app.ui.workspace_registry import TooManyWorkspacesError, WorkspaceRegistry


class ViewRequest(Body):
    """What a workspace is to show."""

    clip_id: Annotated[str, Field(max_length=64)]
    recognition_id: Annotated[str | None, Field(max_length=64)] = None
    language_id: Annotated[str | None, Field(max_length=64)] = None
    start: Annotated[float | None, Field(ge=0, allow_inf_nan=False)] = None
    end: Annotated[float | None, Field(ge=0, allow_inf_nan=False)] = None
    keep_frame: StrictBool = False
    """Whether the clock goes on where it is, in the same clip."""


def view_of(studio: Studio, request: ViewRequest) -> WorkspaceView:
    """Return the clip and the recognition that a request names.

    Without a range, the range of the recognition is taken; without a language, the revision that
    recognised it.

    Raises
    ------
    NotFound
        When there is no such clip, recognition or language.
    ProblemError
        409 while the clip's poses are not extracted.

    """
    clip = studio.clips.get(request.clip_id).clip
    recording = recording_of(studio.clips, clip.id, so_far=True)
    record = studio.recognitions.get(request.recognition_id) if request.recognition_id else None
    start, end = request.start, request.end
    if record is not None and start is None and end is None:
        start, end = record.start, record.end
    return WorkspaceView(
        title=clip.name,
        video=studio.clips.video(clip.id),
        recording=recording,
        start=start,
        end=end,
        recognition=load_recognition(record) if record else None,
        expected=record.expected if record else None,
        language=_language(studio, request, record),
    )


def _language(
    studio: Studio, request: ViewRequest, record: RecognitionRecord | None
) -> Language | None:
    if record is not None:
        language = language_of(studio.languages.get(record.language_id, record.revision))
        return try_gesture(studio.clips, language, view_recognition(record).trial) or language
    if request.language_id:
        return language_of(studio.languages.get(request.language_id))
    return None


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


class Seek(Body):
    """Show a frame of the clip, counted from 0."""

    do: Literal["seek"]
    frame: Annotated[int, Field(ge=0)]


class Step(Body):
    """Pause, and go some frames on or back."""

    do: Literal["step"]
    frames: Annotated[int, Field(ge=-1000, le=1000)]


class Play(Body):
    """Play at a speed; negative is backwards, 0 pauses."""

    do: Literal["play"]
    speed: Annotated[float, Field(ge=-16, le=16, allow_inf_nan=False)]


class Loop(Body):
    """Repeat the range on display, or play on."""

    do: Literal["loop"]
    on: StrictBool


Command = Annotated[Seek | Step | Play | Loop, Field(discriminator="do")]

COMMAND: TypeAdapter[Command] = TypeAdapter(Command)


@router.websocket("/{workspace_id}/playback")
async def follow_playback(
    workspace_id: str, browser: WebSocket, workspaces: CurrentWorkspaces, owner: Owner
) -> None:
    """Send every position of the playback, and obey the page's commands."""
    workspace = workspaces.get(workspace_id, owner)
    if workspace is None or not same_origin(browser):
        await browser.close(code=POLICY_VIOLATION)
        return
    await browser.accept()
    # Only the newest position is kept: a slow browser skips frames and does not fall behind.
    newest, loop = Unread[Position](1), asyncio.get_running_loop()

    def put_from_thread(position: Position) -> None:
        # The event loop may be closed when the server stops before the workspace.
        with contextlib.suppress(RuntimeError):
            loop.call_soon_threadsafe(newest.put, position)

    end = workspace.playback.listen(put_from_thread)
    newest.put(workspace.playback.position)
    try:
        await until_one_ends(_obey(browser, workspace.playback), _send(browser, newest))
    finally:
        end()


async def _send(browser: WebSocket, newest: Unread[Position]) -> None:
    with contextlib.suppress(RuntimeError):
        async for position in newest:
            await browser.send_json(asdict(position))


async def _obey(browser: WebSocket, playback: Playback) -> None:
    while True:
        try:
            command = COMMAND.validate_json(await browser.receive_text())
        except (ValidationError, KeyError):
            await browser.close(code=UNSUPPORTED_DATA)
            return
        match command:
            case Seek():
                playback.seek(command.frame)
            case Step():
                playback.step(command.frames)
            case Play():
                playback.play(command.speed)
            case Loop():
                playback.set_loop(command.on)
