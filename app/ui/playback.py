"""Playback clock of a workspace: selects the frame on display and times the next one."""

from __future__ import annotations

import time as clock
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from threading import Condition, Thread

END_REST_SECONDS = 0.6
"""Pause on the last frame before playback repeats, so that the end is visible."""

SPEEDS = (0.25, 16.0)
"""Least and largest speed in either direction; displays do not keep up with higher ones."""


@dataclass(frozen=True)
class Position:
    """State of playback.

    Attributes
    ----------
    frame, frames
        Index of the frame on display and number of frames in the clip, counted from 0.
    time
        Seconds in the clip, by its container.
    playing
        Whether it plays.
    speed
        Factor on real time; negative is backwards.
    loop
        Whether the range on display repeats.
    picture
        Index of the frame whose picture is on display. It differs from `frame` for a long clip,
        of which not all pictures are kept, and during decoding. None without a picture.

    """

    frame: int
    frames: int
    time: float
    playing: bool
    speed: float
    loop: bool
    picture: int | None = None


class Playback:
    """Plays, seeks and pauses over the timestamps of a clip.

    One thread draws: however many seeks arrive meanwhile, only the newest is drawn next, and two
    frames are never drawn at once (viser runs callbacks in parallel and in any order).

    Parameters
    ----------
    show
        Draws a frame and returns the index of its picture, None without one; called from the
        playback's own thread.

    """

    def __init__(self, show: Callable[[int], int | None]) -> None:
        self._show = show
        self._listeners: list[Callable[[Position], None]] = []
        self._changed = Condition()
        self._times: tuple[float, ...] = (0.0,)
        self._span = (0, 0)
        self._frame = 0
        self._picture: int | None = None
        self._speed = 1.0
        self._loop = True
        self._playing = False
        self._pending = False
        self._unplayed = True
        self._closed = False
        self._anchor = (0.0, 0.0)
        self._thread = Thread(target=self._run, name="playback", daemon=True)
        self._thread.start()

    @property
    def frame(self) -> int:
        """The frame requested last."""
        return self._frame

    @property
    def playing(self) -> bool:
        """Whether it plays."""
        return self._playing

    @property
    def position(self) -> Position:
        """The current state."""
        with self._changed:
            return self._position()

    def listen(self, listener: Callable[[Position], None]) -> Callable[[], None]:
        """Call `listener` after every frame drawn, from the playback's thread.

        Returns a function that removes the listener.
        """
        with self._changed:
            self._listeners.append(listener)

        def remove() -> None:
            with self._changed:
                self._listeners.remove(listener)

        return remove

    def load(
        self, times: Sequence[float], frame: int = 0, span: tuple[int, int] | None = None
    ) -> None:
        """Load another clip and stop at `frame`; the first play starts at the range's start.

        Parameters
        ----------
        times
            Seconds, increasing, one per frame.
        frame
            Shown until the first play or seek.
        span
            First and last frame of the range on display, which a loop repeats; None for all.

        """
        with self._changed:
            self._times = tuple(float(moment) for moment in times) or (0.0,)
            last = len(self._times) - 1
            first, end = span or (0, last)
            self._span = (min(max(first, 0), last), min(max(end, 0), last))
            self._playing = False
            self._unplayed = True
            self._set(frame)

    def set_span(self, span: tuple[int, int], times: Sequence[float]) -> None:
        """Set first and last frame of the range on display; the clock goes on where it is.

        `times` as in `load`: a clip whose frames are being read has more of them each time.
        """
        with self._changed:
            self._times, self._span = tuple(times), span
            self._set(self._frame)

    def seek(self, frame: int) -> None:
        """Show `frame`, limited to the clip, and continue from there if playing."""
        with self._changed:
            self._unplayed = False
            self._set(frame)

    def step(self, frames: int) -> None:
        """Pause and move by `frames`; negative is backwards."""
        with self._changed:
            self._playing = False
            self._unplayed = False
            self._set(self._frame + frames)

    def redraw(self, frame: int) -> None:
        """Redraw if `frame` is on display, because its picture has been decoded."""
        with self._changed:
            if frame == self._frame:
                self._pending = True
                self._changed.notify()

    def play(self, speed: float) -> None:
        """Play at `speed` times real time; negative is backwards, 0 pauses."""
        with self._changed:
            if speed:
                slowest, fastest = SPEEDS
                size = min(max(abs(speed), slowest), fastest)
                self._speed = size if speed > 0 else -size
            self._play(speed != 0)

    def set_loop(self, loop: bool) -> None:
        """Repeat the range on display, or play to the end of the clip."""
        with self._changed:
            self._loop = loop
            self._set(self._frame)

    def close(self) -> None:
        """End the thread."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join()

    def _position(self) -> Position:
        frame = self._frame
        return Position(
            frame=frame,
            frames=len(self._times),
            time=self._times[frame],
            playing=self._playing,
            speed=self._speed,
            loop=self._loop,
            picture=self._picture,
        )

    def _play(self, playing: bool) -> None:
        self._playing = playing and len(self._times) > 1 and self._span[0] < self._span[1]
        first, last = self._bounds()
        begin, end = (first, last) if self._speed > 0 else (last, first)
        if self._playing and (self._unplayed or self._frame == end):
            self._frame = begin
        self._unplayed = False
        self._set(self._frame)

    def _bounds(self) -> tuple[int, int]:
        """First and last frame to play: the range on display if it loops and holds the frame."""
        first, last = self._span
        if self._loop and (self._unplayed or first <= self._frame <= last):
            return first, last
        return 0, len(self._times) - 1

    def _set(self, frame: int) -> None:
        self._frame = min(max(frame, 0), len(self._times) - 1)
        self._anchor = (clock.monotonic(), self._times[self._frame])
        self._pending = True
        self._changed.notify()

    def _run(self) -> None:
        while (frame := self._next()) is not None:
            picture = self._show(frame)
            with self._changed:
                self._picture = picture
                position, listeners = self._position(), tuple(self._listeners)
            for listener in listeners:
                listener(position)

    def _next(self) -> int | None:
        """Wait for the next frame to draw; None when closed."""
        with self._changed:
            while not self._closed:
                if self._playing:
                    self._advance()
                if self._pending:
                    self._pending = False
                    return self._frame
                self._changed.wait(self._until_next())
        return None

    def _now(self) -> float:
        """Return the current playback time, in seconds of the clip."""
        started, moment = self._anchor
        return moment + (clock.monotonic() - started) * self._speed

    def _advance(self) -> None:
        """Move to the frame due by the clock; late frames are skipped."""
        first, last = self._bounds()
        now, forward = self._now(), self._speed > 0
        beyond = now - self._times[last] if forward else self._times[first] - now
        if beyond > 0 and not self._loop:
            self._playing = False
            self._set(last if forward else first)
        elif beyond > END_REST_SECONDS * abs(self._speed):
            self._set(first if forward else last)
        else:
            due = min(max(bisect_right(self._times, now) - 1, first), last)
            if due != self._frame:
                self._frame = due
                self._pending = True

    def _until_next(self) -> float | None:
        """Return the seconds until the next frame is due; None when paused."""
        if not self._playing:
            return None
        first, last = self._bounds()
        rest = END_REST_SECONDS * abs(self._speed)
        if self._speed > 0:
            at_end = self._times[last] + rest
            due = at_end if self._frame >= last else self._times[self._frame + 1]
        else:
            due = self._times[first] - rest if self._frame <= first else self._times[self._frame]
        return max(0.001, (due - self._now()) / self._speed)
