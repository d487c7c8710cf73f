"""Synchronization: pairs messages of two topics that have the same stamp."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any, Generic, TypeVar

First = TypeVar("First")
Second = TypeVar("Second")

MOST_WAITING = 15
"""Most messages kept until their partners arrive: half a second of a camera at 30 frames a second,
the time of pose estimation on a slow robot. More raw pictures would fill the memory."""


class StampPairs(Generic[First, Second]):
    """Buffer that pairs messages with the same stamp.

    Both topics may lose messages. Once a pair is complete, older messages are dropped, because they
    could no longer be used in order.

    Attributes
    ----------
    dropped
        Number of messages dropped without a partner.

    """

    def __init__(self) -> None:
        self.dropped = 0
        self._first: OrderedDict[int, First] = OrderedDict()
        self._second: OrderedDict[int, Second] = OrderedDict()

    def first(self, stamp: int, message: First) -> tuple[First, Second] | None:
        """Add a message of the first topic.

        Parameters
        ----------
        stamp
            Stamp in nanoseconds.
        message
            The message.

        Returns
        -------
        The pair, if the partner has arrived; otherwise None.

        """
        if stamp not in self._second:
            self._keep(self._first, stamp, message)
            return None
        partner = self._second.pop(stamp)
        self._drop_before(stamp)
        return message, partner

    def second(self, stamp: int, message: Second) -> tuple[First, Second] | None:
        """Add a message of the second topic; see `first`."""
        if stamp not in self._first:
            self._keep(self._second, stamp, message)
            return None
        partner = self._first.pop(stamp)
        self._drop_before(stamp)
        return partner, message

    def __len__(self) -> int:
        """Return the number of messages without a partner."""
        return len(self._first) + len(self._second)

    def _keep(self, waiting: OrderedDict[int, Any], stamp: int, message: Any) -> None:
        waiting[stamp] = message
        if len(waiting) > MOST_WAITING:
            waiting.popitem(last=False)
            self.dropped += 1

    def _drop_before(self, stamp: int) -> None:
        kinds: tuple[OrderedDict[int, Any], ...] = (self._first, self._second)
        for waiting in kinds:
            for older in [each for each in waiting if each < stamp]:
                del waiting[older]
                self.dropped += 1
