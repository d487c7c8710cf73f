"""Our own recogniser as one of the methods, by its public interface."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from app.recognition import Gesture, GestureError, Language, PoseSequence, Recognizer
from benchmarks.methods.base import Demonstration, Method, Prediction


class OurProfile(Method):
    """A profile of the recogniser."""

    def __init__(self, profile: str) -> None:
        self._profile = profile

    def fit(self, demonstrations: Sequence[Demonstration]) -> None:
        """Make a language of the demonstrations."""
        shown: dict[str, list[Demonstration]] = defaultdict(list)
        for each in demonstrations:
            shown[each.label].append(each)
        gestures = [teach(each) for each in shown.values()]
        self._recognizer = Recognizer(Language("compared", gestures), self._profile)

    def predict(self, take: PoseSequence) -> Prediction:
        """Recognise a take."""
        result = self._recognizer.recognize(take)
        distances = dict(zip(result.gestures, result.scores.tolist(), strict=True))
        return Prediction(result.label, result.pair, distances, result.confidence)


def teach(demonstrations: Sequence[Demonstration]) -> Gesture:
    """Make a gesture of one demonstration or several, with the people who show them.

    Where no landmark moves enough to be salient, all landmarks are.
    """
    first, *others = demonstrations
    gesture = gesture_of(first.label, first.poses, first.person)
    for each in others:
        try:
            gesture = gesture.with_demonstration(each.poses, diver=each.person)
        except GestureError:
            gesture = gesture.with_demonstration(
                each.poses, diver=each.person, salient=each.poses.landmarks
            )
    return gesture


def gesture_of(label: str, demonstration: PoseSequence, person: str = "") -> Gesture:
    """Make a gesture; if no landmark moves enough to be salient, all landmarks are."""
    try:
        return Gesture.from_demonstration(label, demonstration, diver=person)
    except GestureError:
        salient = demonstration.landmarks
        return Gesture.from_demonstration(label, demonstration, diver=person, salient=salient)
