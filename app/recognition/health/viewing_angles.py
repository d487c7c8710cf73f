"""Viewing angles: from where a gesture looks like another one, or is not seen to move."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final

import numpy as np

from app.recognition.gestures.demonstration import condense
from app.recognition.health.finding import DUPLICATE, Finding
from app.recognition.recognizer import Recognizer

ANGLES: Final = (-60, -30, 30, 60)
"""Degrees by which the diver is turned from the demonstration, positive to the diver's own left.
Beyond, the far arm is hidden in any language."""


def find_blind_angles(
    recognizer: Recognizer, advance: Callable[[], None] = lambda: None
) -> Iterator[Finding]:
    """Yield a finding for each gesture that is another one, or lost, when the diver is turned.

    The demonstration itself is turned by its depth; gestures without depth cannot be turned.

    Parameters
    ----------
    recognizer
        Of the language, profile ``full``.
    advance
        Called after each comparison; an exception that it raises ends the work.

    """
    labels = recognizer.language.labels
    for own, gesture in enumerate(recognizer.language.gestures):
        shown = gesture.trajectory
        if shown is None or shown.facing is None or gesture.is_held:
            continue
        lost: list[int] = []
        like: dict[str, list[int]] = {}
        ahead = recognizer.compare(condense(shown)).scores
        for degrees in ANGLES:
            scores = recognizer.compare(condense(shown.turn(degrees))).scores
            advance()
            if not np.isfinite(scores[own]):
                lost.append(degrees)
            # Of gestures that are the same straight ahead, the duplicate is the finding.
            for other in np.flatnonzero((scores < DUPLICATE) & (ahead >= DUPLICATE)).tolist():
                like.setdefault(labels[other], []).append(degrees)
        if lost:
            yield _blind((gesture.label,), "is not seen to move", lost)
        for name, turns in like.items():
            yield _blind((gesture.label, name), f"is the same movement as {name}", turns)


def _blind(gestures: tuple[str, ...], what: str, turns: Sequence[int]) -> Finding:
    message = (
        f"{gestures[0]} {what} when the diver is turned by {list_turns(turns)}: face the camera, "
        "or change the gesture"
    )
    return Finding("blind_angle", gestures, message)


def list_turns(turns: Sequence[int]) -> str:
    """Return turns in words, such as ``30 or 60 degrees to the left``."""
    sides = {
        side: sorted(abs(turn) for turn in turns if (turn > 0) == (side == "left"))
        for side in ("left", "right")
    }
    if sides["left"] == sides["right"]:
        return f"{' or '.join(map(str, sides['left']))} degrees to either side"
    return " and ".join(
        f"{' or '.join(map(str, degrees))} degrees to the {side}"
        for side, degrees in sides.items()
        if degrees
    )
