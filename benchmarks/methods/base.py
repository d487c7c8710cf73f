"""Protocol of a one-shot recognition method that is compared with others (`docs/bench.md`)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from app.recognition import PoseSequence
from app.recognition.poses.sequence import FloatArray


@dataclass(frozen=True, eq=False)
class Demonstration:
    """A take that shows a gesture.

    Attributes
    ----------
    label
        Of the gesture.
    poses
        The take.
    person
        Who shows it.

    """

    label: str
    poses: PoseSequence
    person: str = ""


@dataclass(frozen=True)
class Prediction:
    """What a method says of a take.

    Attributes
    ----------
    label
        The answer; None: the take is refused, or asked about.
    pair
        The two gestures that are asked about, nearest first.
    distances
        By label, smaller = nearer; empty if the method has none, or cannot compare the take.
    confidence
        Of the label, in [0, 1]; answers below a limit are then also counted as refused.

    """

    label: str | None = None
    pair: tuple[str, str] | None = None
    distances: Mapping[str, float] = field(default_factory=dict)
    confidence: float | None = None

    @property
    def nearest(self) -> str | None:
        """The answer, the first of the pair, or the label at the smallest distance."""
        if self.label or self.pair:
            return self.label or (self.pair[0] if self.pair else None)
        return min(self.distances, key=self.distances.__getitem__, default=None)


class Method(ABC):
    """Base of methods."""

    @abstractmethod
    def fit(self, demonstrations: Sequence[Demonstration]) -> None:
        """Learn a language: one demonstration a gesture, or several, by one person or several."""

    @abstractmethod
    def predict(self, take: PoseSequence) -> Prediction:
        """Say what a take is.

        Raises
        ------
        OsgError
            When the take cannot be compared; it then counts as refused.

        """


class NearestDemonstration(Method):
    """Base of methods that answer the nearest demonstration's label and refuse nothing."""

    def fit(self, demonstrations: Sequence[Demonstration]) -> None:
        """Describe the demonstrations."""
        self._labels = [each.label for each in demonstrations]
        self.describe([each.poses for each in demonstrations])

    def predict(self, take: PoseSequence) -> Prediction:
        """Answer the label of the nearest demonstration."""
        distances: dict[str, float] = {}
        for label, distance in zip(self._labels, self.measure(take).tolist(), strict=True):
            distances[label] = min(distance, distances.get(label, distance))
        return Prediction(min(distances, key=distances.__getitem__), distances=distances)

    @abstractmethod
    def describe(self, demonstrations: Sequence[PoseSequence]) -> None:
        """Keep what N demonstrations are compared by."""

    @abstractmethod
    def measure(self, take: PoseSequence) -> FloatArray:
        """Return the distances ``(N,)`` of a take to the demonstrations."""
