"""Stamps: convert between header stamps, nanoseconds, and the recogniser's seconds."""

from __future__ import annotations

from collections.abc import Callable

from builtin_interfaces.msg import Time

NANOSECONDS = 1_000_000_000
"""Nanoseconds in a second."""


def to_nanoseconds(stamp: Time) -> int:
    """Convert a stamp to nanoseconds since the epoch of its clock."""
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


def to_stamp(nanoseconds: int) -> Time:
    """Convert nanoseconds to a stamp, the inverse of `to_nanoseconds`."""
    seconds, rest = divmod(nanoseconds, NANOSECONDS)
    return Time(sec=seconds, nanosec=rest)


class Stopwatch:
    """Clock of the seconds since the first stamp, exact to the nanosecond.

    A float of the seconds since 1970 has steps of a quarter of a microsecond; counted from the
    first picture it is exact to the nanosecond for a hundred days.

    Parameters
    ----------
    origin
        First stamp in nanoseconds.

    """

    def __init__(self, origin: int) -> None:
        self.origin = origin

    def seconds(self, nanoseconds: int) -> float:
        """Convert nanoseconds to seconds after the first stamp."""
        return (nanoseconds - self.origin) / NANOSECONDS

    def stamp(self, seconds: float) -> Time:
        """Convert seconds after the first stamp to a stamp."""
        return to_stamp(self.origin + round(seconds * NANOSECONDS))


class StampOrArrival:
    """Gives messages without a stamp (a stamp of 0) the time of their arrival.

    Parameters
    ----------
    topic
        Name of the topic, for people.
    now
        Present time in nanoseconds.
    report_problem
        Called once, with the first message that has no stamp.

    """

    def __init__(
        self, topic: str, now: Callable[[], int], report_problem: Callable[[str], None]
    ) -> None:
        self._topic = topic
        self._now = now
        self._report_problem = report_problem
        self._told = False

    def __call__(self, stamp: Time) -> int:
        """Return the stamp in nanoseconds, or the present time if there is none."""
        if nanoseconds := to_nanoseconds(stamp):
            return nanoseconds
        if not self._told:
            self._told = True
            self._report_problem(
                f"the messages on {self._topic} have no stamps; the time of their arrival is used, "
                "so gestures are timed less exactly"
            )
        return self._now()
