"""Playback of a workspace over one websocket: the page asks, the clock tells where it stands."""

from __future__ import annotations

import asyncio
import contextlib
from dataclasses import asdict
from typing import Annotated, Literal

from fastapi import APIRouter, WebSocket
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError
from starlette.websockets import WebSocketDisconnect

from app.api.http.websockets import POLICY_VIOLATION, UNSUPPORTED_DATA, same_origin
from app.ui.playback import Playback, Position
from app.ui.workspace_registry import WorkspaceRegistry


class _Wish(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Seek(_Wish):
    """Show a frame of the clip, counted from 0."""

    do: Literal["seek"]
    frame: Annotated[int, Field(ge=0)]


class Step(_Wish):
    """Pause, and go some frames on or back."""

    do: Literal["step"]
    frames: Annotated[int, Field(ge=-1000, le=1000)]


class Play(_Wish):
    """Play at a speed; negative is backwards, 0 pauses."""

    do: Literal["play"]
    speed: Annotated[float, Field(ge=-16, le=16, allow_inf_nan=False)]


class Loop(_Wish):
    """Repeat the range on display, or play on."""

    do: Literal["loop"]
    on: bool


Wish = Annotated[Seek | Step | Play | Loop, Field(discriminator="do")]

WISH: TypeAdapter[Wish] = TypeAdapter(Wish)


def router(registry: WorkspaceRegistry) -> APIRouter:
    """Make the route ``/workspaces/{id}/playback``."""
    routes = APIRouter(prefix="/workspaces", tags=["workspaces"])

    @routes.websocket("/{workspace_id}/playback")
    async def follow(workspace_id: str, browser: WebSocket) -> None:
        workspace = registry.get(workspace_id)
        if workspace is None or not same_origin(browser):
            await browser.close(code=POLICY_VIOLATION)
            return
        await browser.accept()
        newest = _Newest(asyncio.get_running_loop())
        end = workspace.playback.listen(newest.put_from_thread)
        newest.put(workspace.playback.position)
        telling = asyncio.create_task(_tell(browser, newest))
        try:
            await _obey(browser, workspace.playback)
        finally:
            end()
            telling.cancel()
            await asyncio.gather(telling, return_exceptions=True)

    return routes


class _Newest:
    """Holds the newest position only: a slow browser skips frames instead of falling behind."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._position: Position | None = None
        self._arrived = asyncio.Event()

    def put_from_thread(self, position: Position) -> None:
        # The loop may be gone when the server stops before the workspace does.
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self.put, position)

    def put(self, position: Position) -> None:
        self._position = position
        self._arrived.set()

    async def next(self) -> Position | None:
        await self._arrived.wait()
        self._arrived.clear()
        return self._position


async def _tell(browser: WebSocket, newest: _Newest) -> None:
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):
        while (position := await newest.next()) is not None:
            await browser.send_json(asdict(position))


async def _obey(browser: WebSocket, playback: Playback) -> None:
    with contextlib.suppress(WebSocketDisconnect):
        while True:
            try:
                wish = WISH.validate_json(await browser.receive_text())
            except (ValidationError, KeyError):
                await browser.close(code=UNSUPPORTED_DATA)
                return
            match wish:
                case Seek():
                    playback.seek(wish.frame)
                case Step():
                    playback.step(wish.frames)
                case Play():
                    playback.play(wish.speed)
                case Loop():
                    playback.set_loop(wish.on)
