"""Languages and landmarks for the robot's tests, made of numbers."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime, timezone
from functools import cache

from app.recognition import Gesture, Language, PoseSequence, Recording, takes_in
from app.recognition.phrases.grammar import Grammar
from app.robot import ActiveLanguage, Event, LandmarkListener
from tests.api.recordings import recording_of


@cache
def language_of(*labels: str, revision: int = 1) -> Language:
    """Return a language of shapes of `tests.api.recordings`."""
    gestures = [
        Gesture.from_demonstration(label, takes_in(recording_of(label))[0].poses)
        for label in labels
    ]
    made = datetime(2026, 11, 21, tzinfo=timezone.utc)  # else two of the same gestures would differ
    return Language("pool", gestures, created=made, revision=revision)


@cache
def spoken(*labels: str, revision: int = 1) -> ActiveLanguage:
    """Return a language of shapes made ready."""
    return ActiveLanguage.from_json(language_of(*labels, revision=revision).to_json())


@cache
def ambiguous(grammar: Grammar | None = None) -> ActiveLanguage:
    """Return a language in which a circle lies between two gestures, and a line is one."""
    shapes = {"circle": "circle", "ring": "circle", "line": "line"}
    gestures = [
        replace(language_of(shape).gestures[0], label=label) for label, shape in shapes.items()
    ]
    made = replace(language_of("circle"), gestures=gestures, grammar=grammar)
    return ActiveLanguage.from_json(made.to_json())


def moments_of(recording: Recording) -> list[tuple[PoseSequence, float]]:
    """Return what a listener is fed, frame by frame."""
    poses = recording.poses
    return [
        (poses.between(time, time), salute)
        for time, salute in zip(poses.time.tolist(), recording.salute.tolist(), strict=True)
    ]


def run_listener(listener: LandmarkListener, recording: Recording) -> list[Event]:
    """Feed a whole recording without ending the stream."""
    return [event for frame in moments_of(recording) for event in listener.feed(*frame)]
