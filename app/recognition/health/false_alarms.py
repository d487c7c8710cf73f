"""False alarms: simulated background motion that is recognised as a gesture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from app.recognition.errors import PoseError
from app.recognition.gestures.demonstration import condense
from app.recognition.recognizer import Recognizer
from app.recognition.simulation.background_motion import simulate_background_motion


@dataclass(frozen=True)
class FalseAlarm:
    """The recognition of one example of background motion.

    Attributes
    ----------
    kind
        Of the movement, in words.
    nearest
        Index of the nearest gesture; None where no landmark that a gesture needs moves.
    taken
        Whether it was recognised as that gesture.
    seconds
        Duration of the movement.

    """

    kind: str
    nearest: int | None
    taken: bool
    seconds: float


def find_false_alarms(
    recognizer: Recognizer,
    count: int,
    *,
    seed: int = 0,
    advance: Callable[[], None] = lambda: None,
) -> tuple[FalseAlarm, ...]:
    """Recognise simulated background motion, `count` examples of each kind.

    `advance` is called after each; an exception that it raises ends the work.
    """
    found = []
    for movement in simulate_background_motion(count, seed=seed):
        seconds = float(movement.trajectory.time[-1])
        try:
            result = recognizer.recognize_trajectory(condense(movement.trajectory))
        except PoseError:  # no landmark that a gesture needs moves
            found.append(FalseAlarm(movement.kind, None, False, seconds))
        else:
            nearest = recognizer.language.labels.index(result.nearest)
            found.append(FalseAlarm(movement.kind, nearest, result.label is not None, seconds))
        advance()
    return tuple(found)
