"""Playback websocket of a workspace: takes commands of the page, sends positions."""

from __future__ import annotations

import asyncio
import contextlib
from dataclasses import asdict
from typing import Annotated, Literal

from fastapi import APIRouter, WebSocket
from pydantic import Field, StrictBool, TypeAdapter, ValidationError

from app.api.events.broadcast import Unread
from app.api.http.schemas.values import Body
from app.api.http.websockets import (
    POLICY_VIOLATION,
    UNSUPPORTED_DATA,
    same_origin,
    until_one_ends,
)
from app.api.viser_workspaces.workspace_lookup import CurrentWorkspaces, Owner
from app.ui.playback import Playback, Position


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


router = APIRouter(prefix="/workspaces", tags=["workspaces"])


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
