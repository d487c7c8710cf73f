"""Protocol of a one-shot recognition method that is compared with others."""

from __future__ import annotations

from abc import ABC, abstractmethod

from app.recognition import PoseSequence


class Method(ABC):
    """Base of methods: learns one demonstration per gesture and labels queries."""

    @abstractmethod
    def add(self, label: str, demonstration: PoseSequence) -> None:
        """Add a gesture by its demonstration.

        Raises
        ------
        OsgError
            When the method cannot use it.

        """

    def prepare(self) -> None:  # noqa: B027 - most methods have nothing to do here
        """Prepare for queries after gestures were added."""

    @abstractmethod
    def answer(self, query: PoseSequence) -> str | None:
        """Return the label of a query; None if the method cannot compare it."""
