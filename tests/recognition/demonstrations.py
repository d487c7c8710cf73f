"""Languages of a simulated diver, with a health known beforehand."""

from app.recognition import Gesture, Language
from tests.recognition.strategies import Shape, recording

ARMS = ("left_shoulder", "right_shoulder", "left_hip", "right_hip", "left_wrist", "right_wrist")
"""Landmarks enough for a torso and both hands."""


def shown(label: str, shape: Shape, *, frames: int = 45) -> Gesture:
    """Return a gesture of the right hand, demonstrated at 30 Hz."""
    return Gesture.from_demonstration(label, recording(shape, frames=frames, landmarks=ARMS))


def pool(**shapes: Shape) -> Language:
    """Return a language of these gestures."""
    return Language("pool", [shown(label, shape) for label, shape in shapes.items()])
