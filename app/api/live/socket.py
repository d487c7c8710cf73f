"""The live view: a page sends a camera's frames, and is told what is seen in them.

One websocket a view. Frames are looked at one after the other in a thread of their own; while one
is looked at only the newest of those that arrive is kept, so the answer is never about the past.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from typing import Annotated, Final, Literal

from fastapi import APIRouter, WebSocket
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.concurrency import run_in_threadpool
from starlette.websockets import WebSocketDisconnect

from app.api.http.websockets import POLICY_VIOLATION, UNSUPPORTED_DATA, same_origin
from app.api.live.watcher import Frame, Watcher
from app.api.services.context import CurrentStudio, Studio
from app.recognition import OsgError, Recognizer
from app.recognition.errors import EstimatorError, ModelError, VideoError
from app.recognition.estimation import create_estimator
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.gestures.profile import ProfileName
from app.store import NotFound

MESSAGE_TOO_BIG, INTERNAL_ERROR, TRY_AGAIN_LATER = 1009, 1011, 1013
"""Websocket close codes (RFC 6455, 7.4.1, and its registry)."""

NO_FRAMES = 4408
"""Close code of our own, after HTTP's 408: nothing came for `SILENCE_SECONDS`."""

MOST_REASON_BYTES: Final = 123
"""Of a close frame's reason (RFC 6455, 5.5)."""

MOST_FRAME_BYTES: Final = 1024 * 1024
"""Of one frame; the page's are around 100 kB."""

MOST_VIEWS: Final = 2
"""Live views at the same time: each keeps two cores busy, and a laptop has not many more."""

SILENCE_SECONDS: Final = 60.0
"""A view without frames for so long is closed: its place may be wanted by another one."""

EstimatorSource = Callable[[], PoseEstimator]


class Listen(BaseModel):
    """Which language to ask from now on; none: only landmarks and takes are wanted."""

    model_config = ConfigDict(extra="forbid")

    do: Literal["listen"]
    language_id: Annotated[str, Field(max_length=64)] | None = None
    profile: ProfileName | None = Field(default=None, description="Null: the language's own")


class Listening(BaseModel):
    """Answer to `Listen`: what will be asked, or why nothing can be."""

    kind: Literal["listening"] = "listening"
    language: str | None = None
    gestures: int = 0
    problem: str | None = None


class _End(Exception):
    """Ends a view, with what the page is told."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(reason)
        self.code = code
        # Cut at a character, not inside one.
        self.reason = reason.encode()[:MOST_REASON_BYTES].decode(errors="ignore")


def router(
    create: EstimatorSource = create_estimator,
    *,
    most_views: int = MOST_VIEWS,
    silence_seconds: float = SILENCE_SECONDS,
) -> APIRouter:
    """Make the route ``/live``.

    Parameters
    ----------
    create
        Makes the estimator of a view.
    most_views
        How many there may be at the same time.
    silence_seconds
        After how long without a frame one is closed.

    """
    routes = APIRouter(tags=["live"])
    places = asyncio.Semaphore(most_views)

    @routes.websocket("/live")
    async def watch(browser: WebSocket, studio: CurrentStudio) -> None:
        if not same_origin(browser):
            await browser.close(POLICY_VIOLATION, "foreign_origin")
            return
        # Only an accepted websocket can be told why it is closed.
        await browser.accept()
        try:
            if places.locked():
                raise _End(TRY_AGAIN_LATER, f"{most_views} live views are open already; close one")
            async with places, _view(browser, studio, create) as view:
                await view.run(silence_seconds)
        except _End as end:
            with contextlib.suppress(RuntimeError, WebSocketDisconnect):
                await browser.close(end.code, end.reason)

    return routes


@asynccontextmanager
async def _view(
    browser: WebSocket, studio: Studio, create: EstimatorSource
) -> AsyncIterator[_View]:
    try:
        estimator = await run_in_threadpool(create)
    except (ModelError, EstimatorError) as error:
        raise _End(INTERNAL_ERROR, str(error)) from error
    view = _View(browser, studio, estimator)
    try:
        yield view
    finally:
        await asyncio.shield(run_in_threadpool(view.close))


class _View:
    """One open live view."""

    def __init__(self, browser: WebSocket, studio: Studio, estimator: PoseEstimator) -> None:
        self._browser = browser
        self._studio = studio
        self._wanted: Listen | None = None
        self._watcher = Watcher(estimator, studio.settings.water, self._recognizer)
        self._thread = ThreadPoolExecutor(1, "live")
        self._newest: Frame | None = None
        self._arrived = asyncio.Event()

    async def run(self, silence_seconds: float) -> None:
        """Look and answer until the page leaves.

        Raises
        ------
        _End
            When something else ends it.

        """
        tasks = [
            asyncio.create_task(self._receive()),
            asyncio.create_task(self._look(silence_seconds)),
        ]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            ends = await asyncio.gather(*tasks, return_exceptions=True)
        for end in ends:
            if isinstance(end, Exception) and not isinstance(end, WebSocketDisconnect):
                raise end

    def close(self) -> None:
        """Wait for the look that goes on, and release the models."""
        self._thread.shutdown()
        self._watcher.close()

    async def _receive(self) -> None:
        """Keep the newest frame, and do what else is asked."""
        while True:
            message = await self._browser.receive()
            if message["type"] == "websocket.disconnect":
                return
            if (content := message.get("bytes")) is not None:
                self._keep(content)
            else:
                await self._listen(message.get("text") or "")

    def _keep(self, content: bytes) -> None:
        if len(content) > MOST_FRAME_BYTES:
            raise _End(MESSAGE_TOO_BIG, f"a frame of {len(content)} bytes; send smaller ones")
        skipped = 0 if self._newest is None else self._newest.skipped + 1
        try:
            self._newest = Frame.parse(content, skipped)
        except VideoError as error:
            raise _End(UNSUPPORTED_DATA, str(error)) from error
        self._arrived.set()

    async def _listen(self, text: str) -> None:
        try:
            self._wanted = Listen.model_validate_json(text)
        except ValidationError as error:
            reason = f"not understood: {error.errors()[0]['msg']}"
            raise _End(UNSUPPORTED_DATA, reason) from error
        answer = Listening()
        try:
            # Made ready now, so that the first take need not wait for it.
            if recognizer := await run_in_threadpool(self._recognizer):
                language = recognizer.language
                answer = Listening(language=language.name, gestures=len(language.gestures))
        except OsgError as error:
            answer = Listening(problem=str(error))
        await self._browser.send_text(answer.model_dump_json())

    async def _look(self, silence_seconds: float) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                async with asyncio.timeout(silence_seconds):
                    await self._arrived.wait()
            except TimeoutError as error:
                reason = f"no frame came for {silence_seconds:g} s"
                raise _End(NO_FRAMES, reason) from error
            frame, self._newest = self._newest, None
            self._arrived.clear()
            assert frame is not None
            try:
                answers = await loop.run_in_executor(self._thread, self._watcher.look, frame)
            except OsgError as error:
                raise _End(UNSUPPORTED_DATA, str(error)) from error
            for answer in answers:
                await self._browser.send_text(answer.model_dump_json())

    def _recognizer(self) -> Recognizer | None:
        """Return a recogniser of the wanted language as it is now."""
        wanted = self._wanted
        if wanted is None or wanted.language_id is None:
            return None
        try:
            state = self._studio.languages.get(wanted.language_id)
        except NotFound as error:
            raise OsgError(f"{error}; choose another language") from error
        return self._studio.recognizer(state, wanted.profile)
