"""Playback websocket of a workspace: takes commands of the page, sends positions."""

from __future__ import annotations

import asyncio
import contextlib
from dataclasses import asdict
from typing import Annotated, Literal

from fastapi import APIRouter, WebSocket
from pydantic import Field, TypeAdapter, ValidationError
from starlette.websockets import WebSocketDisconnect

from app.api.http.schemas.values import Body
from app.api.http.websockets import POLICY_VIOLATION, UNSUPPORTED_DATA, same_origin
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
    on: bool


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
    newest = _Newest(asyncio.get_running_loop())
    end = workspace.playback.listen(newest.put_from_thread)
    newest.put(workspace.playback.position)
    sending = asyncio.create_task(_send(browser, newest))
    try:
        await _obey(browser, workspace.playback)
    finally:
        end()
        sending.cancel()
        await asyncio.gather(sending, return_exceptions=True)


class _Newest:
    """Holds only the newest position: a slow browser skips frames and does not fall behind."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._position: Position | None = None
        self._arrived = asyncio.Event()

    def put_from_thread(self, position: Position) -> None:
        # The event loop may be closed when the server stops before the workspace.
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self.put, position)

    def put(self, position: Position) -> None:
        self._position = position
        self._arrived.set()

    async def next(self) -> Position | None:
        await self._arrived.wait()
        self._arrived.clear()
        return self._position


async def _send(browser: WebSocket, newest: _Newest) -> None:
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):
        while (position := await newest.next()) is not None:
            await browser.send_json(asdict(position))


async def _obey(browser: WebSocket, playback: Playback) -> None:
    with contextlib.suppress(WebSocketDisconnect):
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
