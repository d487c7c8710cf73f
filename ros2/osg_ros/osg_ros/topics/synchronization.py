"""Messages of two topics about the same picture, brought together by their stamps."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any, Generic, TypeVar

First = TypeVar("First")
Second = TypeVar("Second")

MOST_WAITING = 15
"""Messages kept for their partner: half a second of a usual camera, which pose estimation takes on
a slow robot. They may be raw pictures, and fill memory."""


class StampPairs(Generic[First, Second]):
    """Joins what has the same stamp.

    Both topics may lose messages. Once a pair is complete, whatever is older than it could no
    longer be used in order, and is dropped.

    Attributes
    ----------
    dropped
        Count of messages that never found their partner.

    """

    def __init__(self) -> None:
        self.dropped = 0
        self._first: OrderedDict[int, First] = OrderedDict()
        self._second: OrderedDict[int, Second] = OrderedDict()

    def first(self, stamp: int, message: First) -> tuple[First, Second] | None:
        """Take a message of the first topic.

        Parameters
        ----------
        stamp
            Nanoseconds.
        message
            Anything.

        Returns
        -------
        The pair, if its partner had come.

        """
        if stamp not in self._second:
            self._keep(self._first, stamp, message)
            return None
        partner = self._second.pop(stamp)
        self._drop_before(stamp)
        return message, partner

    def second(self, stamp: int, message: Second) -> tuple[First, Second] | None:
        """Take a message of the second topic; see `first`."""
        if stamp not in self._first:
            self._keep(self._second, stamp, message)
            return None
        partner = self._first.pop(stamp)
        self._drop_before(stamp)
        return partner, message

    def __len__(self) -> int:
        """Count what waits."""
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
