"""Languages of a simulated diver, with known health."""

from functools import cache

from app.recognition import Gesture, Language, Recognizer
from tests.recognition.strategies import SHAPES, Shape, recording

ARMS = ("left_shoulder", "right_shoulder", "left_hip", "right_hip", "left_wrist", "right_wrist")
"""Landmarks of a torso and both hands."""


def shown(label: str, shape: Shape, *, frames: int = 45) -> Gesture:
    """Return a gesture of the right hand, demonstrated at 30 Hz."""
    return Gesture.from_demonstration(label, recording(shape, frames=frames, landmarks=ARMS))


def pool(**shapes: Shape) -> Language:
    """Return a language of these gestures."""
    return Language("pool", [shown(label, shape) for label, shape in shapes.items()])


@cache
def drawn_language() -> Language:
    """Return the language of all `SHAPES`, made when a test first asks for it."""
    shapes = SHAPES.items()
    return Language(
        "pool", [Gesture.from_demonstration(label, recording(s)) for label, s in shapes]
    )


@cache
def drawn_recognizer(profile: str) -> Recognizer:
    """Return a recogniser of `drawn_language`."""
    return Recognizer(drawn_language(), profile)
