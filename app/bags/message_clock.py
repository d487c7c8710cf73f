"""Message clock: when a message's picture was taken, by the stamp in its header."""

from __future__ import annotations

from dataclasses import dataclass, field

from app.bags.bag import Message
from app.recognition.recording.timestamps import DISCONTINUITY, FrameClock, tell_jumps


@dataclass
class MessageClock:
    """Computes the times of a topic's messages.

    Time is the stamp in the headers, at which the picture was taken; if the first message has none,
    it is the time of reception. Where the stamps jump and reception does not, their clock was set:
    time goes on as reception does.

    Attributes
    ----------
    by_header
        Whether time is that of the headers; None before the first message.
    jumps
        Seconds by which the headers' clock was set, each time; negative: back.

    """

    by_header: bool | None = None
    jumps: list[float] = field(default_factory=list)
    _last: tuple[int, int] | None = field(default=None, init=False)
    _first: int = field(default=0, init=False)
    _frames: FrameClock = field(default_factory=FrameClock, init=False)

    def stamp(self, message: Message) -> int:
        """Return the stamp of a message in nanoseconds as it is, 0 without one."""
        if self.by_header is None:
            self.by_header = message.stamp > 0
        return message.stamp if self.by_header else message.received

    def after_first(self, message: Message) -> int | None:
        """Return the exact nanoseconds after the first stamp; None without a stamp."""
        stamp = self.stamp(message)
        if not stamp:
            return None
        if self._last is None:
            self._first = stamp
        else:
            ahead = stamp - self._last[0]
            jump = ahead - max(0, message.received - self._last[1])
            if min(abs(ahead), abs(jump)) > DISCONTINUITY * 1e9 and ahead * jump > 0:
                self.jumps.append(jump / 1e9)
                self._first += jump
        self._last = stamp, message.received
        return stamp - self._first

    def seconds(self, after_first: int | None) -> float:
        """Return the seconds of the next frame, given its nanoseconds after the first stamp."""
        return self._frames.seconds(None if after_first is None else after_first / 1e9)

    def list_warnings(self, topic: str, frames: int) -> list[str]:
        """Return sentences about the times of the frames read so far."""
        found = []
        if self.by_header is False:
            found.append(
                f"messages of {topic} say not when the picture was taken; time is when they were "
                "received"
            )
        if self._frames.repaired:
            found.append(
                f"{self._frames.repaired} of {frames} messages had no timestamp, or one not later "
                "than that of the message before; their time is estimated"
            )
        steady = tell_jumps(self.jumps, "time goes on as messages were received")
        return [*found, *steady, *self._frames.sentences]
