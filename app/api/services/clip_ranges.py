"""Clip ranges: the range of a clip that a request selects, or a problem that says what is wrong."""

from __future__ import annotations

from app.api.http.problems import ProblemError
from app.recognition.errors import AmbiguousRangeError, RangeError
from app.recognition.recording.clip_range import Demonstration, find_demonstration
from app.recognition.recording.recording import Recording
from app.recognition.triggers.trigger import SALUTE, Trigger


def demonstration_in(
    recording: Recording,
    start: float | None = None,
    end: float | None = None,
    *,
    keep_transit: bool = False,
    trigger: Trigger = SALUTE,
) -> Demonstration:
    """Find the demonstration meant by a range of seconds; see `find_demonstration`.

    Raises
    ------
    ProblemError
        422 when the range is empty or reversed, or no range is given and there are several takes.

    """
    try:
        return find_demonstration(recording, start, end, keep_transit=keep_transit, trigger=trigger)
    except AmbiguousRangeError as error:
        raise ProblemError(422, "take_ambiguous", str(error)) from error
    except RangeError as error:
        pointer = "/start" if start is not None else "/end"
        raise ProblemError(422, "range_empty", str(error), pointer=pointer) from error
