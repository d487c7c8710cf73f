"""Our own recogniser as one of the methods, by its public interface."""

from __future__ import annotations

from app.recognition import Gesture, GestureError, Language, PoseError, PoseSequence, Recognizer
from benchmarks.methods.base import Method


class OurProfile(Method):
    """A profile of the recogniser; answers with the nearest gesture, even if the take is rejected.

    The other methods never reject, so that rejections cannot be compared.
    """

    def __init__(self, profile: str) -> None:
        self._profile = profile
        self._gestures: list[Gesture] = []
        self._recognizer: Recognizer | None = None

    def add(self, label: str, demonstration: PoseSequence) -> None:
        """Make a gesture of the demonstration."""
        self._gestures.append(gesture_of(label, demonstration))

    def prepare(self) -> None:
        """Make the language of the gestures."""
        self._recognizer = Recognizer(Language("compared", self._gestures), self._profile)

    def answer(self, query: PoseSequence) -> str | None:
        """Return the nearest gesture's label."""
        assert self._recognizer is not None, "call prepare first"
        try:
            return self._recognizer.recognize(query).nearest
        except PoseError:
            return None


def gesture_of(label: str, demonstration: PoseSequence) -> Gesture:
    """Make a gesture; if no landmark moves enough to be salient, all landmarks are."""
    try:
        return Gesture.from_demonstration(label, demonstration)
    except GestureError:
        return Gesture.from_demonstration(label, demonstration, salient=demonstration.landmarks)
