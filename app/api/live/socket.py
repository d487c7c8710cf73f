"""Live websocket: a page sends a camera's frames and receives landmarks and recognitions.

Each view has one websocket. Its frames are processed one after the other in a separate thread.
While one is processed, only the newest arrival is kept, so that answers are never about the past.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from functools import partial
from typing import Annotated, Final, Literal

from fastapi import APIRouter, WebSocket
from pydantic import BaseModel, Field, ValidationError
from starlette.concurrency import run_in_threadpool
from starlette.websockets import WebSocketDisconnect

from app.api.http.schemas.values import Body
from app.api.http.websockets import (
    POLICY_VIOLATION,
    UNSUPPORTED_DATA,
    same_origin,
    until_one_ends,
)
from app.api.live.frame_pipeline import Frame, FramePipeline, Recognized
from app.api.services.running_studio import Languages, ServerSettings
from app.api.services.stored_languages import recognizer_of
from app.recognition import OsgError, Recognizer
from app.recognition.errors import EstimatorError, ModelError, VideoError
from app.recognition.estimation.estimator import PoseEstimator
from app.recognition.estimation.factory import create_estimator
from app.recognition.estimation.water import WaterCorrection
from app.recognition.gestures.profile import ProfileName
from app.store import Invitation, LanguageStore, NotFound

MESSAGE_TOO_BIG, INTERNAL_ERROR, TRY_AGAIN_LATER = 1009, 1011, 1013
"""Websocket close codes (RFC 6455, 7.4.1, and its registry)."""

NO_FRAMES = 4408
"""Private close code, modelled on HTTP's 408: no frame came for `SILENCE_SECONDS`."""

MOST_REASON_BYTES: Final = 123
"""Most bytes of a close frame's reason (RFC 6455, 5.5)."""

MOST_FRAME_BYTES: Final = 1024 * 1024
"""Most bytes of one frame; the page's frames have around 100 kB."""

MOST_VIEWS: Final = 2
"""Most live views at the same time: each keeps two cores busy, and a laptop has few more."""

INVITED_PROTOCOL: Final = "osg-studio.take"
"""Subprotocol of an invited person's websocket, beside which the page sends the token."""

MOST_INVITED: Final = 1
"""Most invited people whose camera is looked at at the same time."""

INVITED_SECONDS: Final = 90.0
"""Longest look at an invited person's camera, for one take: another one may wait for the place."""

PLACE_SECONDS: Final = 3.0
"""Seconds to wait for a place: longer than who left it takes to process a last frame."""

SILENCE_SECONDS: Final = 60.0
"""Seconds without frames after which a view is closed, to make place for another one."""


class Listen(Body):
    """Which language to ask from now on; none: only landmarks and takes are wanted."""

    do: Literal["listen"]
    language_id: Annotated[str, Field(max_length=64)] | None = None
    profile: ProfileName | None = None
    """Null: the language's own."""


class Listening(BaseModel):
    """Answer to `Listen`: what will be asked, or why nothing can be."""

    kind: Literal["listening"] = "listening"
    language: str | None = None
    gestures: int = 0
    problem: str | None = None


class _End(Exception):
    """Ends a view with a close code and a reason."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(reason)
        self.code = code
        # Cut at a character, not inside one.
        self.reason = reason.encode()[:MOST_REASON_BYTES].decode(errors="ignore")


router = APIRouter(tags=["live"])


@router.websocket("/live")
@router.websocket("/invited/live")
async def watch_camera(browser: WebSocket, languages: Languages, settings: ServerSettings) -> None:
    """Take a camera's frames, and send what is found in them.

    For an invited person this is when a take begins and ends, and not what is read in it.
    """
    if not same_origin(browser):
        await browser.close(POLICY_VIOLATION, "foreign_origin")
        return
    invitation: Invitation | None = getattr(browser.state, "invitation", None)
    places: asyncio.Semaphore = browser.app.state.live_places
    language_id, seconds = None, None
    full = f"{MOST_VIEWS} live views are open already; close one"
    if invitation is not None:
        places = browser.app.state.invited_places
        language_id, seconds = invitation.language_id, INVITED_SECONDS
        full = "another person's take is looked at"
    # Only an accepted websocket can be closed with a reason.
    await browser.accept(None if invitation is None else INVITED_PROTOCOL)
    create = partial(_View, browser, languages, settings.water, language_id)
    try:
        async with _place(places, full), _view(create) as view:
            try:
                await asyncio.wait_for(view.run(), seconds)
            except TimeoutError as error:
                raise _End(NO_FRAMES, "one take is looked at, and not for longer") from error
    except _End as end:
        with contextlib.suppress(RuntimeError, WebSocketDisconnect):
            await browser.close(end.code, end.reason)


@asynccontextmanager
async def _place(places: asyncio.Semaphore, full: str) -> AsyncIterator[None]:
    """Hold a place; one that was left a moment ago is free once its last frame is processed."""
    try:
        await asyncio.wait_for(places.acquire(), PLACE_SECONDS)
    except TimeoutError as error:
        raise _End(TRY_AGAIN_LATER, full) from error
    try:
        yield
    finally:
        places.release()


@asynccontextmanager
async def _view(create: Callable[[PoseEstimator], _View]) -> AsyncIterator[_View]:
    try:
        estimator = await run_in_threadpool(create_estimator)
    except (ModelError, EstimatorError) as error:
        raise _End(INTERNAL_ERROR, str(error)) from error
    view = create(estimator)
    try:
        yield view
    finally:
        await asyncio.shield(run_in_threadpool(view.close))


class _View:
    """One open live view; that of an invited person has a language, and may not choose another."""

    def __init__(
        self,
        browser: WebSocket,
        languages: LanguageStore,
        water: WaterCorrection,
        language_id: str | None,
        estimator: PoseEstimator,
    ) -> None:
        self._browser = browser
        self._languages = languages
        self._invited = language_id is not None
        self._wanted: Listen | None = None
        if language_id is not None:
            self._wanted = Listen(do="listen", language_id=language_id)
        self._pipeline = FramePipeline(estimator, water, self._recognizer)
        self._thread = ThreadPoolExecutor(1, "live")
        self._newest: Frame | None = None
        self._arrived = asyncio.Event()

    async def run(self) -> None:
        """Process frames and answer until the page leaves.

        Raises
        ------
        _End
            When something else ends it.

        """
        await until_one_ends(self._receive(), self._look())

    def close(self) -> None:
        """Wait for the frame being processed, and release the models."""
        self._thread.shutdown()
        self._pipeline.close()

    async def _receive(self) -> None:
        """Keep the newest frame, and handle the page's other messages."""
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
        if self._invited:
            raise _End(UNSUPPORTED_DATA, "only frames are taken here")
        try:
            self._wanted = Listen.model_validate_json(text)
        except ValidationError as error:
            reason = f"not understood: {error.errors()[0]['msg']}"
            raise _End(UNSUPPORTED_DATA, reason) from error
        answer = Listening()
        try:
            # Built now, so that the first take need not wait for it.
            if recognizer := await run_in_threadpool(self._recognizer):
                language = recognizer.language
                answer = Listening(language=language.name, gestures=len(language.gestures))
        except OsgError as error:
            answer = Listening(problem=str(error))
        await self._browser.send_text(answer.model_dump_json())

    async def _look(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                async with asyncio.timeout(SILENCE_SECONDS):
                    await self._arrived.wait()
            except TimeoutError as error:
                reason = f"no frame came for {SILENCE_SECONDS:g} s"
                raise _End(NO_FRAMES, reason) from error
            frame, self._newest = self._newest, None
            self._arrived.clear()
            assert frame is not None
            try:
                answers = await loop.run_in_executor(self._thread, self._pipeline.look, frame)
            except OsgError as error:
                raise _End(UNSUPPORTED_DATA, str(error)) from error
            for answer in answers:
                if self._invited and isinstance(answer, Recognized):
                    answer = Recognized(start=answer.start, end=answer.end, closed=answer.closed)
                await self._browser.send_text(answer.model_dump_json())

    def _recognizer(self) -> Recognizer | None:
        """Return a recogniser of the requested language in its present state."""
        wanted = self._wanted
        if wanted is None or wanted.language_id is None:
            return None
        try:
            state = self._languages.get(wanted.language_id)
        except NotFound as error:
            raise OsgError(f"{error}; choose another language") from error
        return recognizer_of(state, wanted.profile)
