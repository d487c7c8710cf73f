"""Timestamps: the seconds of a video's frames, from the container, repaired where invalid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

FALLBACK_STEP = 1 / 25
"""Seconds between frames where the file has no rate: the slowest usual rate (PAL), so that repaired
time does not run ahead."""

SHORTEST_STEP, LONGEST_STEP = 1 / 1000, 0.5
"""Plausible seconds between neighbouring frames: from a high-speed camera's 1000 frames a second
to the longest gap that a trajectory bridges (`app.recognition.poses.sequence.MAX_GAP_SECONDS`).

A container's nominal rate is often wrong (1000 a second in a WebM recorded by a browser)."""

NUDGE = 0.25
"""Share of a step by which a frame is moved behind one with the same timestamp: so little that the
next valid timestamp is later, also where two frames are out of order and the step seems double.
"""

DISCONTINUITY = 1.0
"""Seconds back from which a jump is a restart of the clock (joined files, a counter that wraps) and
not a frame out of order: B-frames reorder by a few frames at most."""

LONGEST_PAUSE = 60.0
"""Seconds ahead from which a jump is a clock that is set, as on a computer without a battery for
its clock, or a camera that rested: no player waits for so long."""

SEAM = 3.0
"""Seconds that stand for an unknown time, where a clock was set or begins again: no take of two
such parts gets a label, as of every hole of `2 * SHORTEST_TAKE` and a salute."""


@dataclass
class FrameClock:
    """Computes a strictly increasing time for every frame, in display order.

    The first frame is at 0 s, every other one at the container's timestamp, whatever the nominal
    rate. Four errors are repaired and counted:

    - no timestamp: one step after the frame before;
    - not later than the frame before (duplicates, frames out of order): `NUDGE` of a step after
      it;
    - more than `DISCONTINUITY` back, or `LONGEST_PAUSE` ahead: the clock restarted or was set; this
      frame comes `SEAM` after the one before, and all later ones are moved along with it.

    A step is the last plausible difference of two timestamps.

    Attributes
    ----------
    step
        Seconds between frames as far as known: the nominal value first, then as seen.
    repaired
        Number of frames whose timestamp was missing or not usable.
    jumps
        Seconds by which the clock was set ahead, each time.
    restarts
        Seconds at which it began again.

    """

    step: float = FALLBACK_STEP
    repaired: int = 0
    jumps: list[float] = field(default_factory=list)
    restarts: list[float] = field(default_factory=list)
    _last: float | None = field(default=None, init=False)
    _last_stamp: float | None = field(default=None, init=False)
    _shift: float = field(default=0.0, init=False)

    @property
    def sentences(self) -> tuple[str, ...]:
        """What is told of a clock that was set or began again."""
        found = tell_jumps(self.jumps, "no gesture is read across it")
        if not self.restarts:
            return found
        times = f", {len(self.restarts)} times in all" if len(self.restarts) > 1 else ""
        return (
            *found,
            f"the clock begins again at {self.restarts[0]:.2f} s{times}: several recordings in one "
            "file? No gesture is read across the seam; give each recording by itself",
        )

    def __post_init__(self) -> None:
        """Replace an implausible nominal step."""
        if not SHORTEST_STEP <= self.step <= LONGEST_STEP:
            self.step = FALLBACK_STEP

    def seconds(self, stamp: float | None) -> float:
        """Return the time of the next frame.

        Parameters
        ----------
        stamp
            The container's timestamp, in seconds from any fixed moment; None: missing.

        Returns
        -------
        Seconds after the first frame, greater than at every call before.

        """
        if self._last is None:
            self._shift = -(stamp or 0.0)
            self.repaired += stamp is None
            now = 0.0
        else:
            now = self._following(stamp, self._last)
        self._last, self._last_stamp = now, stamp
        return now

    def _following(self, stamp: float | None, last: float) -> float:
        if stamp is None:
            self.repaired += 1
            return last + self.step
        now = stamp + self._shift
        if self._last_stamp is not None:
            gap = stamp - self._last_stamp
            if SHORTEST_STEP <= gap <= LONGEST_STEP:
                self.step = gap
        if now > last + LONGEST_PAUSE:
            self.jumps.append(now - last - self.step)
            self._shift -= now - last - SEAM
            return last + SEAM
        if now > last:
            return now
        self.repaired += 1
        if last - now > DISCONTINUITY:
            self.restarts.append(last)
            self._shift += last + SEAM - now
            return last + SEAM
        return last + NUDGE * self.step


def tell_jumps(jumps: Sequence[float], then: str) -> tuple[str, ...]:
    """Return a sentence about a clock that was set; none where it was not.

    Parameters
    ----------
    jumps
        Seconds by which it was set, each time; back where they are negative.
    then
        How time goes on.

    """
    if not jumps:
        return ()
    times = f", {len(jumps)} times in all" if len(jumps) > 1 else ""
    way = "ahead" if jumps[0] > 0 else "back"
    return (
        f"the clock was set while it was recorded, {way} by {abs(jumps[0]):.0f} s{times}; {then}",
    )
