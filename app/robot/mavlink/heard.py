"""Heard seconds: those in which the vehicle was heard, so that a lost link uses up none.

A limit in heard seconds says so; every other counts all seconds.
"""

from __future__ import annotations

import math
from typing import Final

SILENT_SECONDS: Final = 5.0
"""Seconds without a heartbeat after which the vehicle counts as lost."""

LONGEST_GAP: Final = 1.5
"""Seconds from one message of the vehicle to the next that count as heard: half again the period of
its heartbeat."""


class HeardClock:
    """Clock that goes on only while the vehicle is heard.

    Attributes
    ----------
    seconds
        Heard seconds until now.
    last
        When the vehicle was heard last, in seconds of a steady clock; minus infinity for never.

    """

    def __init__(self, last: float = -math.inf) -> None:
        self.seconds = 0.0
        self.last = last

    def hear(self, now: float) -> None:
        """Note that the vehicle is heard now, in seconds of a steady clock."""
        self.seconds += min(max(now - self.last, 0), LONGEST_GAP)
        self.last = now
