"""Live frame source: gives the newest frame, reconnects a camera that stalls or dies."""

from __future__ import annotations

import threading
import time as clock
from collections import deque
from collections.abc import Callable, Iterator
from datetime import datetime, timezone
from typing import Final, Protocol

from app.recognition.errors import SourceError
from app.recognition.poses.frame import Image
from app.robot.events import SourceLost, SourceRestored
from app.robot.sources.source import Frame, NoFrame, Notice

FIRST_WAIT, LONGEST_WAIT = 0.5, 15.0
"""Seconds before a lost camera is opened again, doubled with every attempt that fails: a loose plug
is back within a second, a camera that reboots within a minute, and opening costs a robot power."""

STEADY_SECONDS: Final = 30.0
"""A camera that lasted so long starts with the first wait again; one that dies sooner would come
and go twice a second for days."""

LONGEST_CLOSING: Final = 3.0
"""Seconds that closing waits for a read that goes on; a camera gives a frame in less."""

SHORTEST_STEP: Final = 1e-6
"""Seconds between two frames, at least: steady clocks of some systems tick only every 16 ms."""

QUIET_SECONDS: Final = 0.5
"""Without a frame for so long a `NoFrame` is given, so that the caller can handle a signal."""

MOST_NOTICES: Final = 64
"""That wait to be taken; the oldest are forgotten first. A camera that flaps must not fill memory
while nobody listens."""


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
            When none comes, or none will come any more.

        """
        ...

    def close(self) -> None:
        """Release it."""
        ...


class LiveSource:
    """A `Source` that gives the newest frame and drops those that nobody asked for in time.

    A thread of its own reads the camera. A failure of the camera is reported once; it is then
    opened again, after ever longer waits, until it gives frames. A frame's time is when it
    arrived here, in seconds of this machine's steady clock since the source was opened: clocks of
    cameras restart when they do, and some streams have none.

    Parameters
    ----------
    name
        For people, without passwords.
    opened
        Opens the camera; called again after it was lost.
    first_wait
        Seconds before it is opened again for the first time.

    Raises
    ------
    SourceError
        When it cannot be opened now, or gives no first frame: most likely the name is wrong.

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
        """Give the newest frame, and what happened to the camera, until the source is closed."""
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
        """Read until the source is closed; the thread's work."""
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
        """Open the camera again, as often as it takes; None when the source is closed meanwhile."""
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
        """Queue a notice, and drop the frame before it that nobody has taken."""
        with self._news:
            if self._newest is not None:
                self._newest = None
                self._dropped += 1
            self._notices.append(notice)
            self._news.notify_all()


def _first_frame(opened: Callable[[], Camera]) -> tuple[Camera, Image]:
    """Open a camera and prove that it gives frames."""
    camera = opened()
    try:
        return camera, camera.read()
    except BaseException:
        camera.close()
        raise
