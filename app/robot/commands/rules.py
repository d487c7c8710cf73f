"""Rules of the command dialogue: how sure, near, fresh and often shown a gesture must be."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from numbers import Real

CONFIRM_SECONDS = 20.0
"""Time for the diver to read the robot's display and repeat a gesture, salutes included. A gesture
of the sample clips takes 4 to 6 s, so this leaves two attempts."""

STALE_SECONDS = 3.0
"""Longest delay from the picture that ended a gesture to its arrival. Pose estimation on a slow
robot takes well below a second; a later message was held up, replayed, or has a wrong clock."""

EMERGENCY_AGE_SECONDS = 10.0
"""Largest age of an emergency: a slow robot's queue of pictures is shorter, a recording that is
played again is older."""

EMERGENCY_CONFIDENCE = 0.2
"""Lowest confidence of an emergency, far below the sample clips' gestures: 0.73 and more."""

EMERGENCY_LIMIT = 0.75
"""Largest novelty of an emergency. Other gestures are accepted up to 1, because they must be shown
twice."""


def to_number(value: object) -> float:
    """Return a number as a float, NaN for all else: text, truth values and infinity too."""
    with suppress(OverflowError):
        if isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value):
            return float(value)
    return math.nan


@dataclass(frozen=True)
class Rules:
    """Rules of a `CommandDialogue`.

    Attributes
    ----------
    confirmed
        Whether a gesture or a message must be repeated before its command is given.
    confirm_seconds
        Longest time from a gesture to the end of its repetition. For a message: longest time to
        each next gesture of its repetition, and from the last one to its end.
    stale_seconds
        Largest difference between a gesture's stamp and the current time, in either direction; for
        labels in `cancel` there is no limit.
    least_confidence
        Lowest confidence that counts: a gesture below it is rejected, a message not understood.
    cancel
        Labels that cancel a pending gesture or message. Their own commands are not given.
    emergency
        Labels whose commands are given at once.
    emergency_seconds
        The same as `stale_seconds`, of an emergency.
    emergency_confidence
        The same as `least_confidence`, of an emergency; the larger of the two counts.

    Raises
    ------
    ValueError
        When a number is out of its range, or a label is in both `cancel` and `emergency`.

    """

    confirmed: bool = True
    confirm_seconds: float = CONFIRM_SECONDS
    stale_seconds: float = STALE_SECONDS
    least_confidence: float = 0.0
    cancel: frozenset[str] = frozenset()
    emergency: frozenset[str] = frozenset()
    emergency_seconds: float = EMERGENCY_AGE_SECONDS
    emergency_confidence: float = EMERGENCY_CONFIDENCE

    def __post_init__(self) -> None:
        """Validate the values; a wrong one would give commands at the wrong moment."""
        for name in ("confirm_seconds", "stale_seconds", "emergency_seconds"):
            if not to_number(seconds := getattr(self, name)) > 0:
                raise ValueError(f"{name} is {seconds!r}; give seconds above 0")
        for name in ("least_confidence", "emergency_confidence"):
            if not 0 <= to_number(share := getattr(self, name)) <= 1:
                raise ValueError(f"{name} is {share!r}; give 0 to 1")
        if both := sorted(self.cancel & self.emergency):
            raise ValueError(
                f"{both} cancel and are emergencies as well; take them out of one of the two lists"
            )
