"""Time: the nanoseconds of a header's stamp, and the seconds that the recogniser counts in."""

from __future__ import annotations

from builtin_interfaces.msg import Time

NANOSECONDS = 1_000_000_000
"""In a second."""


def nanoseconds_of(stamp: Time) -> int:
    """Return a stamp as nanoseconds since the epoch of its clock."""
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


def stamp_of(nanoseconds: int) -> Time:
    """Return the message of a moment, the inverse of `nanoseconds_of`."""
    seconds, rest = divmod(nanoseconds, NANOSECONDS)
    return Time(sec=seconds, nanosec=rest)


class Stopwatch:
    """Seconds since the first stamp, so that none of its nanoseconds is lost.

    A float of the seconds since 1970 is only good to a quarter of a microsecond; counted from the
    first picture it is exact to the nanosecond for a hundred days.

    Parameters
    ----------
    origin
        The first stamp in nanoseconds.

    """

    def __init__(self, origin: int) -> None:
        self.origin = origin

    def seconds(self, nanoseconds: int) -> float:
        """Return seconds after the first stamp."""
        return (nanoseconds - self.origin) / NANOSECONDS

    def stamp(self, seconds: float) -> Time:
        """Return the stamp that lies so many seconds after the first one."""
        return stamp_of(self.origin + round(seconds * NANOSECONDS))
