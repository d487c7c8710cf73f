"""Stream order: drops late and repeated frames, and detects the beginning of another stream."""

from __future__ import annotations

from app.recognition import PoseSequence

LATE_SECONDS = 1.0
"""Seconds by which a frame may be late. Networks reorder frames within less time, and a clock that
was set back by less catches up before anybody notices."""

MOST_LATE = 8
"""Number of consecutive frames, in order and later than `LATE_SECONDS`, that show that the clock
was set back or another stream has begun: a third of a second of a camera."""

SaluteFrame = tuple[PoseSequence, float]
"""The poses of one frame, and its salute score."""


class StreamOrder:
    """Compares each frame of a stream with the one before.

    Attributes
    ----------
    late
        Number of frames dropped.
    reason
        Reason to clear the memory before the frames of the last call are processed; empty if these
        continue the stream.

    """

    def __init__(self) -> None:
        self.late = 0
        self.reason = ""
        self._last: PoseSequence | None = None
        self._behind: list[SaluteFrame] = []

    @property
    def time(self) -> float:
        """Seconds of the last frame processed; 0 before any."""
        return 0.0 if self._last is None else float(self._last.time[0])

    def admit(self, moment: PoseSequence, salute: float) -> list[SaluteFrame]:
        """Return the frames to process when this one arrives.

        The list is empty for a frame that is older than the last one, or the same. Frames of
        another stream are held until they cannot be late frames, and then returned together.
        """
        last, self.reason = self._last, ""
        behind = 0.0 if last is None else self.time - float(moment.time[0])
        if last is not None and behind >= 0:
            self.late += 1
            if self._behind and moment.time[0] <= self._behind[-1][0].time[0]:
                self._behind.clear()
            self._behind.append((moment, salute))
            if behind <= LATE_SECONDS or len(self._behind) < MOST_LATE:
                del self._behind[:-MOST_LATE]
                return []
            self.reason = f"the source's time went back, from {self.time:.2f} s to "
            self.reason += f"{moment.time[0]:.2f} s"
            frames, self._behind = self._behind, []
            self.late -= len(frames)
        else:
            self._behind.clear()
            self.reason = "" if last is None else _describe_difference(last, moment)
            frames = [(moment, salute)]
        self._last = moment
        return frames

    def restart(self) -> None:
        """Forget the last frame: any frame may come next."""
        self._last = None
        self._behind.clear()


def _describe_difference(last: PoseSequence, moment: PoseSequence) -> str:
    """Return why one frame cannot follow another in the same take; empty where it can."""
    if moment.frame_size != last.frame_size:
        old, new = (f"{width} x {height}" for width, height in (last.frame_size, moment.frame_size))
        return f"the picture's size changed, from {old} to {new} pixels"
    if moment.landmarks != last.landmarks:
        return f"the landmarks changed, from {len(last.landmarks)} to {len(moment.landmarks)}"
    return ""
