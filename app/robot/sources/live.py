"""Live frame source: gives the newest frame, reconnects a camera that stalls or dies."""

from __future__ import annotations

import threading
import time as clock
from collections import deque
from collections.abc import Callable, Iterator
from datetime import datetime, timezone
from typing import Final, Protocol

import numpy as np

from app.recognition.errors import SourceError
from app.recognition.poses.frame import Image
from app.recognition.recording.video import Turn
from app.robot.events import SourceLost, SourceRestored
from app.robot.sources.source import Frame, NoFrame, Notice

FIRST_WAIT, LONGEST_WAIT = 0.5, 15.0
"""Shortest and longest wait in seconds before a lost camera is reopened, doubled after every failed
attempt: a loose plug is back within a second, a camera that reboots within a minute, and opening
uses a robot's power."""

STEADY_SECONDS: Final = 30.0
"""Seconds for which a camera must work before the first wait applies again; otherwise a camera that
fails at once would be reopened twice a second for days."""

LONGEST_CLOSING: Final = 3.0
"""Seconds that closing waits for the current read; a camera gives a frame in less."""

SHORTEST_STEP: Final = 1e-6
"""Smallest difference in seconds between two frames: some steady clocks tick only every 16 ms."""

QUIET_SECONDS: Final = 0.5
"""Seconds without a frame after which a `NoFrame` is given, so that the caller can handle a
signal."""

MOST_NOTICES: Final = 64
"""Number of unread notices kept, the newest; an unstable camera must not fill memory while nobody
reads them."""


class Camera(Protocol):
    """An opened camera or stream, read by one thread."""

    def read(self) -> Image:
        """Wait for the next frame.

        Returns
        -------
        ``(height, width, 3)`` RGB, upright.

        Raises
        ------
        SourceError
            When no frame comes, or none will come any more.

        """

    def close(self) -> None:
        """Release the camera."""


class TurnedCamera:
    """A camera that is mounted turned; a `Camera`.

    Parameters
    ----------
    opened
        Opens the camera itself.
    turn
        Degrees, clockwise, by which its pictures are turned.

    """

    def __init__(self, opened: Callable[[], Camera], turn: Turn) -> None:
        self._camera = opened()
        self._quarters = -turn // 90

    def read(self) -> Image:
        """Wait for the next frame; see `Camera`."""
        return np.ascontiguousarray(np.rot90(self._camera.read(), self._quarters))

    def close(self) -> None:
        """Release the camera."""
        self._camera.close()


class LiveSource:
    """A `Source` that gives the newest frame and drops frames that were not requested in time.

    A separate thread reads the camera. A failure is reported once; the camera is then reopened,
    after ever longer waits, until it gives frames. A frame's time is its arrival, in seconds of
    this machine's steady clock since the source was opened: a camera's clock restarts with the
    camera, and some streams have none.

    Parameters
    ----------
    name
        Name for people, without passwords.
    opened
        Opens the camera; called again after the camera is lost.
    first_wait
        Seconds before the first attempt to reopen it.

    Raises
    ------
    SourceError
        When the camera cannot be opened now, or gives no first frame: most likely the name is
        wrong.

    """

    live = True

    def __init__(
        self, name: str, opened: Callable[[], Camera], *, first_wait: float = FIRST_WAIT
    ) -> None:
        self.name = name
        self._opened = opened
        self._first_wait = first_wait
        self._wait = first_wait
        self.began = datetime.now(timezone.utc)
        self._began = clock.monotonic()
        self._stamp = -SHORTEST_STEP
        self._news = threading.Condition()
        self._closing = threading.Event()
        self._notices: deque[Notice] = deque(maxlen=MOST_NOTICES)
        self._newest: Frame | None = None
        self._dropped = 0
        self._fault: Exception | None = None
        camera, image = _first_frame(opened)
        self.frame_size = (image.shape[1], image.shape[0])
        self._keep(image)
        self._thread = threading.Thread(target=self._read, args=(camera,), name="camera")
        self._thread.daemon = True  # a driver that hangs must not keep the process from ending
        self._thread.start()

    def __iter__(self) -> Iterator[Frame | Notice]:
        """Yield the newest frames and the notices about the camera until the source is closed."""
        while not self._closing.is_set():
            yield self._next()

    def close(self) -> None:
        """Stop reading and release the camera."""
        self._closing.set()
        with self._news:
            self._news.notify_all()
        self._thread.join(timeout=LONGEST_CLOSING)

    def _next(self) -> Frame | Notice:
        with self._news:
            if not self._notices and self._newest is None:
                self._news.wait(QUIET_SECONDS)
            if self._fault is not None:
                raise self._fault
            if self._notices:
                return self._notices.popleft()
            if self._newest is None:
                return NoFrame(self.now())
            frame, self._newest, self._dropped = self._newest, None, 0
            return frame

    def now(self) -> float:
        """Return the current time of its clock, in seconds."""
        return clock.monotonic() - self._began

    def _read(self, camera: Camera) -> None:
        """Read until the source is closed; runs in the thread."""
        current: Camera | None = camera
        try:
            while current is not None:
                began = clock.monotonic()
                reason = self._read_until_lost(current)
                if clock.monotonic() - began > STEADY_SECONDS:
                    self._wait = self._first_wait
                current = None if reason is None else self._reopen(reason)
        except Exception as error:  # passed on to the iterating thread
            with self._news:
                self._fault = error
                self._news.notify_all()

    def _read_until_lost(self, camera: Camera) -> str | None:
        """Return why the camera was lost, or None when the source was closed."""
        try:
            while not self._closing.is_set():
                self._keep(camera.read())
        except SourceError as error:
            return str(error)
        finally:
            camera.close()
        return None

    def _reopen(self, reason: str) -> Camera | None:
        """Reopen the camera, however many attempts it takes; None once the source is closed."""
        self._tell(SourceLost(self.now(), reason))
        attempts = 0
        while not self._closing.wait(self._wait):
            self._wait = min(2 * self._wait, LONGEST_WAIT)
            attempts += 1
            try:
                camera, image = _first_frame(self._opened)
            except SourceError:
                continue
            now = self.now()
            self._tell(SourceRestored(now, now - self._stamp, attempts))
            self._keep(image)
            return camera
        return None

    def _keep(self, image: Image) -> None:
        with self._news:
            if self._newest is not None:
                self._dropped += 1
            self._stamp = max(self.now(), self._stamp + SHORTEST_STEP)
            self._newest = Frame(self._stamp, image, self._dropped)
            self._news.notify_all()

    def _tell(self, notice: SourceLost | SourceRestored) -> None:
        """Queue a notice, and drop an earlier frame that nobody has taken."""
        with self._news:
            if self._newest is not None:
                self._newest = None
                self._dropped += 1
            self._notices.append(notice)
            self._news.notify_all()


def _first_frame(opened: Callable[[], Camera]) -> tuple[Camera, Image]:
    """Open a camera and read its first frame, to verify that it gives frames."""
    camera = opened()
    try:
        return camera, camera.read()
    except BaseException:
        camera.close()
        raise
