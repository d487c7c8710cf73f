"""The clock of a workspace: which frame is on display, and when the next one is due."""

from __future__ import annotations

import time as clock
from bisect import bisect_right
from collections.abc import Callable, Sequence
from threading import Condition, Thread

END_REST_SECONDS = 0.6
"""How long the last frame stands before playback starts again: long enough to see the end."""


class Playback:
    """Plays, seeks and pauses over the timestamps of a recording.

    One thread draws: however many seeks arrive meanwhile, only the newest is drawn next, and two
    frames are never drawn at once (viser runs callbacks in parallel and in any order).

    Parameters
    ----------
    show
        Draws a frame; called from the playback's own thread.

    """

    def __init__(self, show: Callable[[int], None]) -> None:
        self._show = show
        self._changed = Condition()
        self._times: tuple[float, ...] = (0.0,)
        self._frame = 0
        self._speed = 1.0
        self._playing = False
        self._pending = False
        self._untouched = True
        self._closed = False
        self._anchor = 0.0
        self._thread = Thread(target=self._run, name="playback", daemon=True)
        self._thread.start()

    @property
    def frame(self) -> int:
        """The frame asked for last."""
        return self._frame

    @property
    def playing(self) -> bool:
        """Whether the clock runs."""
        return self._playing

    def load(self, times: Sequence[float], frame: int = 0) -> None:
        """Take over another recording and stop at `frame`; playing begins at the start even so.

        Parameters
        ----------
        times
            Seconds, increasing, one per frame.
        frame
            Where to stand until someone plays or seeks.

        """
        with self._changed:
            self._times = tuple(float(moment) for moment in times) or (0.0,)
            self._playing = False
            self._untouched = True
            self._set(frame)

    def seek(self, frame: int) -> None:
        """Show `frame`, or the nearest there is, and go on from there if playing."""
        with self._changed:
            self._untouched = False
            self._set(frame)

    def redraw(self, frame: int) -> None:
        """Draw again if `frame` is the one on display: its picture has arrived."""
        with self._changed:
            if frame == self._frame:
                self._pending = True
                self._changed.notify()

    def toggle(self) -> bool:
        """Play or pause; from the end it starts over. Returns whether it plays now."""
        with self._changed:
            self._playing = not self._playing and len(self._times) > 1
            if self._playing and (self._untouched or self._frame >= len(self._times) - 1):
                self._frame = 0
            self._untouched = False
            self._set(self._frame)
            return self._playing

    def set_speed(self, speed: float) -> None:
        """Play `speed` times as fast as the camera saw it."""
        with self._changed:
            self._speed = speed
            self._set(self._frame)

    def close(self) -> None:
        """End the thread."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join()

    def _set(self, frame: int) -> None:
        self._frame = min(max(frame, 0), len(self._times) - 1)
        self._anchor = clock.monotonic() - self._elapsed(self._frame) / self._speed
        self._pending = True
        self._changed.notify()

    def _elapsed(self, frame: int) -> float:
        return self._times[frame] - self._times[0]

    def _run(self) -> None:
        while (frame := self._next()) is not None:
            self._show(frame)

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

    def _advance(self) -> None:
        """Move to the frame that the clock says is due; frames that come late are left out."""
        position = (clock.monotonic() - self._anchor) * self._speed
        if position > self._elapsed(len(self._times) - 1) + END_REST_SECONDS:
            self._set(0)
            return
        due = bisect_right(self._times, self._times[0] + position) - 1
        if due > self._frame:
            self._frame = due
            self._pending = True

    def _until_next(self) -> float | None:
        """Seconds until the clock has something new to show; None when it stands still."""
        if not self._playing:
            return None
        last = len(self._times) - 1
        due = (
            self._elapsed(self._frame + 1)
            if self._frame < last
            else self._elapsed(last) + END_REST_SECONDS
        )
        return max(0.001, due / self._speed - (clock.monotonic() - self._anchor))
