"""Alarms: accidental movements that the recogniser takes for a gesture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from app.recognition.errors import PoseError
from app.recognition.gestures.gesture import condense
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.background_motion import simulate_background_motion


@dataclass(frozen=True)
class FalseAlarm:
    """How one accidental movement was read.

    Attributes
    ----------
    kind
        Of the movement, in words.
    nearest
        Index of the nearest gesture; None where nothing that a gesture needs moved.
    taken
        Whether it was taken for that gesture.

    """

    kind: str
    nearest: int | None
    taken: bool


def find_false_alarms(
    recognizer: Recognizer,
    count: int,
    *,
    seed: int = 0,
    advance: Callable[[], None] = lambda: None,
) -> tuple[FalseAlarm, ...]:
    """Let the recogniser read accidental movements, `count` of each kind.

    `advance` is called after each; what it raises ends the reading.
    """
    found = []
    for movement in simulate_background_motion(count, seed=seed):
        try:
            result = recognizer.recognize_trajectory(condense(movement.trajectory))
        except PoseError:  # nothing that any gesture needs moves in it
            found.append(FalseAlarm(movement.kind, None, taken=False))
        else:
            nearest = recognizer.language.labels.index(result.nearest)
            found.append(FalseAlarm(movement.kind, nearest, result.label is not None))
        advance()
    return tuple(found)
