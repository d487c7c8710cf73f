"""Demonstration faults: salutes and rests inside a demonstration, and strokes cut short."""

from __future__ import annotations

from app.api.services.running_studio import Studio
from app.api.services.salute_ranges import Outline, count_salutes, outline_of
from app.recognition.triggers.trigger import SALUTE, Trigger

CUT_SHARE = 0.2
"""Missing share of a stroke from which a demonstration counts as cut short: the rest is another
gesture, as in `counterfactual_candidates.LEAST_KEPT`."""

REST_SHARE = 1 / 3
"""Share of rest before and after the movement from which it counts as a fault of a demonstration:
divers' tempos differ by less than a third of the duration."""

LEAST_REST = 0.5
"""Shortest rest that counts, in seconds; a hand stops for less between two strokes."""


def describe_fault(
    studio: Studio, clip_id: str, start: float, end: float, trigger: Trigger = SALUTE
) -> str | None:
    """Return the fault of a range as a demonstration, as a clause; None if no fault is known."""
    outline = outline_of(studio, clip_id, trigger)
    return None if outline is None else fault_in(outline, start, end, trigger)


def describe_count(trigger: Trigger, count: int) -> str:
    """Return a number of a language's triggers in words, such as "a Vulcan salute"."""
    if trigger.kind == "pose":
        return "a trigger's pose of the arms" if count == 1 else f"{count} of the trigger's poses"
    return "a Vulcan salute" if count == 1 else f"{count} Vulcan salutes"


def fault_in(outline: Outline, start: float, end: float, trigger: Trigger = SALUTE) -> str | None:
    """Return the fault of a range of a clip with these parts, see `describe_fault`."""
    if salutes := count_salutes(outline.salutes, start, end):
        contained = describe_count(trigger, salutes)
        whole = start <= outline.start + LEAST_REST and end >= outline.end - LEAST_REST
        return f"is the whole clip, with {contained}" if whole else f"contains {contained}"
    for first, last in outline.strokes:
        kept = min(end, last) - max(start, first)
        if 0 < kept < (1 - CUT_SHARE) * (last - first):
            return f"is cut short: it keeps {kept:.1f} of {last - first:.1f} s of the stroke"
    rest = max(0.0, outline.moving[0] - start) + max(0.0, end - outline.moving[1])
    if rest >= max(LEAST_REST, REST_SHARE * (end - start)):
        return f"contains {rest:.1f} s of rest before and after the gesture"
    return None
