"""Languages of a simulated diver, with known health."""

from collections.abc import Mapping
from dataclasses import replace
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


TAUGHT = {name: SHAPES[name] for name in ("circle", "wedge", "infinity", "square")}
"""The gestures of `shown_by`."""


def shown_by(divers: tuple[str, ...], shapes: Mapping[str, Shape] = TAUGHT) -> Language:
    """Return a language of which each diver has shown every gesture once, in another size."""
    gestures = []
    for name, shape in shapes.items():
        takes = [
            recording(shape, frames=70 + 9 * at, torso=80 - 6 * at, jitter=0.01 * at)
            for at in range(len(divers))
        ]
        gesture = Gesture.from_demonstration(name, takes[0], diver=divers[0])
        for take, diver in zip(takes[1:], divers[1:], strict=True):
            gesture = gesture.with_demonstration(take, diver)
        gestures.append(gesture)
    return Language("pool", gestures)


def with_wrong_take() -> Language:
    """Return a language of three people, of whom Cy shows a wedge as circle."""
    language = shown_by(("Ann", "Bo", "Cy"))
    wrong = recording(SHAPES["wedge"], frames=88, torso=68)
    gestures = [
        gesture.without_demonstration(2).with_demonstration(wrong, "Cy")
        if gesture.label == "circle"
        else gesture
        for gesture in language.gestures
    ]
    return replace(language, gestures=gestures)


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
