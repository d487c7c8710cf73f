"""Time left of a job, from its rate since its first report."""

from __future__ import annotations

LEAST_SHARE = 0.05
"""Share of the frames after which the rate is known; before, models load and caches fill."""


class TimeLeft:
    """Estimates the time left of one job."""

    def __init__(self) -> None:
        self._first: tuple[int, float] | None = None

    def estimate(self, done: int, total: int, now: float) -> float | None:
        """Return the seconds left; None while the rate is not known.

        Parameters
        ----------
        done, total
            Frames.
        now
            Seconds on a monotonic clock.

        """
        if self._first is None:
            self._first = (done, now)
        frames, elapsed = done - self._first[0], now - self._first[1]
        if frames <= 0 or elapsed <= 0 or done < LEAST_SHARE * total:
            return None
        return round(elapsed / frames * max(0, total - done), 1)
