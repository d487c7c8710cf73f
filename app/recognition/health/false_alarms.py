"""Alarms: accidental movements that the recogniser takes for a gesture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from app.recognition.errors import PoseError
from app.recognition.gestures.gesture import condensed
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.accidental_motion import accidental_movements


@dataclass(frozen=True)
class Alarm:
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


def alarms(
    recognizer: Recognizer,
    count: int,
    *,
    seed: int = 0,
    advance: Callable[[], None] = lambda: None,
) -> tuple[Alarm, ...]:
    """Let the recogniser read accidental movements, `count` of each kind.

    `advance` is called after each; what it raises ends the reading.
    """
    found = []
    for movement in accidental_movements(count, seed=seed):
        try:
            result = recognizer.recognize_trajectory(condensed(movement.trajectory))
        except PoseError:  # nothing that any gesture needs moves in it
            found.append(Alarm(movement.kind, None, taken=False))
        else:
            nearest = recognizer.language.labels.index(result.nearest)
            found.append(Alarm(movement.kind, nearest, result.label is not None))
        advance()
    return tuple(found)
