"""Clip range: the selected part of a recording: a take, a chosen range, or all of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from app.recognition.errors import AmbiguousRangeError, RangeError
from app.recognition.poses.sequence import PoseSequence
from app.recognition.recording.recording import Recording, find_unseen
from app.recognition.recording.segmentation import Bracket, cut_take, find_brackets
from app.recognition.recording.trimming import Span
from app.recognition.triggers.trigger import SALUTE, Trigger

SAME_MOMENT = 1e-3
"""Seconds within which a given moment is a take's: numbers travel through JSON and text fields
rounded to milliseconds, and no camera takes a thousand frames a second of a diver."""


@dataclass(frozen=True)
class ClipRange:
    """A part of a clip: a take's stroke, a chosen range, or all of it.

    Attributes
    ----------
    start, end
        Seconds in the clip between which `poses` lies.
    poses
        Those of this part.
    unseen
        Spans of it, or of its take, in which a trigger may have been missed.

    """

    start: float
    end: float
    poses: PoseSequence
    unseen: tuple[Span, ...] = ()


def find_clip_range(
    recording: Recording,
    start: float | None = None,
    end: float | None = None,
    *,
    keep_transit: bool = False,
    trigger: Trigger = SALUTE,
) -> ClipRange:
    """Find the part of a clip that is meant by a first and last second.

    A range that equals a take, from salute to salute, selects its stroke, without the transits
    unless `keep_transit`. Any other range is used unchanged. Without a range, the clip's only take
    is selected, or all of a clip without salutes.

    Takes are what lies between salutes, or other triggers of a language.

    Raises
    ------
    AmbiguousRangeError
        When no range is given and there are several takes.
    RangeError
        When the range is empty or reversed.

    """
    takes = find_brackets(recording, trigger)
    poses = recording.poses
    if start is None and end is None:
        if len(takes) > 1:
            spans = ", ".join(f"{take.start:.2f}-{take.end:.2f} s" for take in takes)
            raise AmbiguousRangeError(
                f"the clip holds {len(takes)} takes ({spans}); say which by start and end"
            )
        if takes:
            return _shown_in(poses, takes[0], trigger, keep_transit)
    first = float(poses.time[0]) if start is None else start
    last = float(poses.time[-1]) if end is None else end
    if (take := _find_take(takes, first, last)) is not None:
        return _shown_in(poses, take, trigger, keep_transit)
    inside = poses.between(first - SAME_MOMENT, last + SAME_MOMENT)
    if last <= first or not len(inside):
        raise RangeError(
            f"no frames lie between {first:g} s and {last:g} s; the clip goes from "
            f"{poses.time[0]:g} s to {poses.time[-1]:g} s",
            "/end" if start is None else "/start",
        )
    return ClipRange(first, last, inside, find_unseen_in(poses, takes, first, last))


def find_unseen_in(
    poses: PoseSequence, takes: Sequence[Bracket], start: float, end: float
) -> tuple[Span, ...]:
    """Return the spans of a range, or of the take that it equals, in which a trigger may be missed.

    Parameters
    ----------
    poses
        Of the whole recording.
    takes
        All of it, from `find_brackets`.
    start, end
        Seconds of the range.

    """
    if (take := _find_take(takes, start, end)) is not None:
        return take.unseen
    inside = poses.between(start - SAME_MOMENT, end + SAME_MOMENT)
    begin, finish = max(start, float(poses.time[0])), min(end, float(poses.time[-1]))
    return find_unseen(inside.time.tolist(), begin, finish)


def _find_take(takes: Sequence[Bracket], start: float, end: float) -> Bracket | None:
    """Return the take that a range equals, from salute to salute; None without one."""
    for take in takes:
        if abs(take.start - start) <= SAME_MOMENT and abs(take.end - end) <= SAME_MOMENT:
            return take
    return None


def find_surroundings(
    recording: Recording, start: float, end: float, trigger: Trigger = SALUTE
) -> PoseSequence:
    """Return the poses around a range: the take around it between its triggers, or the clip."""
    for take in find_brackets(recording, trigger):
        if take.start - SAME_MOMENT <= start and end <= take.end + SAME_MOMENT:
            return recording.poses.between(take.start, take.end)
    return recording.poses


def _shown_in(
    poses: PoseSequence, bracket: Bracket, trigger: Trigger, keep_transit: bool
) -> ClipRange:
    take = cut_take(poses, bracket, trim=not keep_transit, trigger=trigger)
    return ClipRange(take.stroke_start, take.stroke_end, take.poses, take.unseen)
