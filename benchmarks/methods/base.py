"""What a method of one-shot recognition has to do to be compared with others."""

from __future__ import annotations

from abc import ABC, abstractmethod

from app.recognition import PoseSequence


class Method(ABC):
    """Learns one demonstration a gesture and names queries."""

    @abstractmethod
    def add(self, label: str, demonstration: PoseSequence) -> None:
        """Take the demonstration of one more gesture.

        Raises
        ------
        OsgError
            When the method cannot use it.

        """

    def prepare(self) -> None:  # noqa: B027 - most methods have nothing to do here
        """Do what has to be done anew whenever a gesture was added, before the next query."""

    @abstractmethod
    def answer(self, query: PoseSequence) -> str | None:
        """Name the gesture of a query; None where the method sees nothing that it could name."""
