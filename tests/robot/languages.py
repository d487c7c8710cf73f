"""Languages and landmarks for the robot's tests, made of numbers."""

from __future__ import annotations

from functools import cache

from app.recognition import Gesture, Language, takes_in
from app.robot import SpokenLanguage
from tests.api.recordings import recording_of


@cache
def spoken(*labels: str, revision: int = 1) -> SpokenLanguage:
    """Return a language of shapes of `tests.api.recordings`."""
    gestures = [
        Gesture.from_demonstration(label, takes_in(recording_of(label))[0].poses)
        for label in labels
    ]
    return SpokenLanguage.of(Language("pool", gestures, revision=revision))
