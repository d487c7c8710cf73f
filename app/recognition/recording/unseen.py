"""Unseen time: spans in which a trigger may have been missed, and what is odd about a clock.

One rule for takes of every source: a take has a label only if no trigger can have been missed in
it. Between two missed triggers lies the way from one gesture to the next, which may look like a
third one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from app.recognition.poses.sequence import FloatArray
from app.recognition.recording.salute import HOLD_SECONDS, SHORTEST_TAKE
from app.recognition.recording.trimming import SETTING_OUT, Span

LONGER_HELD: Final = 0.4
"""Seconds by which divers hold a trigger longer than it must be held, at least: their shortest
salute lasts 0.7 s (`docs/robots/on-the-boat.md`)."""

UNUSUAL: Final = 3.0
"""How many times the usual step a longer one is to be told as a hole: a dropped frame is not."""

CRAMMED: Final = 1 / 300
"""Seconds between two frames below which they are no camera's: action cameras film 240 a second."""


def find_unseen(
    moments: Sequence[float], start: float, end: float, hold: float = HOLD_SECONDS
) -> tuple[Span, ...]:
    """Find the spans from `start` to `end` in which a trigger may have been missed.

    A trigger that is missed lies between two neighbouring frames that show none. Fingers need time
    to form it and to open: `SETTING_OUT` for both.

    Parameters
    ----------
    moments
        Seconds of the frames that show no trigger, increasing; those outside do not count.
    start, end
        Seconds between which a trigger would count.
    hold
        Seconds that the trigger must be held.

    """
    inside = [start, *(each for each in moments if start < each < end), end]
    least = hold + LONGER_HELD + SETTING_OUT - 1e-9
    return tuple(Span(a, b) for a, b in pairwise(inside) if b - a >= least)


def find_missable(
    moments: Sequence[float], start: float, end: float, hold: float = HOLD_SECONDS
) -> tuple[Span, ...]:
    """Find the same in a take; a trigger nearer to its own ones continues these (`TakeMachine`)."""
    return find_unseen(moments, start + SHORTEST_TAKE, end - SHORTEST_TAKE, hold)


def describe_unseen(unseen: Sequence[Span], noun: str) -> str:
    """Return why a take has no label; `noun` is what may have been missed."""
    return f"too little was seen {_name_spans(unseen)}: a {noun} may have been missed there"


def _name_spans(spans: Sequence[Span]) -> str:
    return " and ".join(f"from {each.start:.2f} to {each.end:.2f} s" for each in spans[:2])


def find_pauses(time: FloatArray) -> tuple[str, ...]:
    """Return a sentence about steps of a stroke that are long, and too short to hide a trigger."""
    steps = np.diff(time)
    long = np.flatnonzero((steps > HOLD_SECONDS) & (steps > UNUSUAL * np.median(steps)))
    if not len(long):
        return ()
    spans = [Span(float(time[at]), float(time[at + 1])) for at in long.tolist()]
    return (f"no frame {_name_spans(spans)}: the path between is a straight line",)


def find_holes(time: FloatArray) -> tuple[Span, ...]:
    """Find the spans without a frame in which a trigger may have been missed.

    Parameters
    ----------
    time
        ``(T,)`` seconds, increasing; each step is compared with the usual one.

    """
    if len(time) < 2:
        return ()
    usual = float(np.median(np.diff(time)))
    found = find_unseen(time.tolist(), float(time[0]), float(time[-1]))
    return tuple(each for each in found if each.end - each.start > UNUSUAL * usual)


def tell_clock(time: FloatArray) -> Iterator[str]:
    """Yield a sentence about each thing that is odd about the times of a recording's frames.

    Parameters
    ----------
    time
        As for `find_holes`.

    """
    steps = np.diff(time)
    crammed, holes = steps[steps < CRAMMED], find_holes(time)
    if len(crammed) > 2:
        yield (
            f"{len(crammed) + 1} of {len(time)} frames are crammed together, "
            f"{1 / np.median(crammed):.0f} a second: their times are not when they were filmed; "
            "write true times, or for keypoints without times give --frame-rate"
        )
    if holes:
        longest = max(holes, key=lambda each: each.end - each.start)
        more = f", the longest of {len(holes)} holes" if len(holes) > 1 else ""
        # A shorter one within a short take is too near to its own salutes to hide others.
        sure = longest.end - longest.start > 2 * SHORTEST_TAKE + 1
        then = "no gesture is read across it" if sure else "a salute may have been missed"
        yield f"no frame from {longest.start:.2f} to {longest.end:.2f} s{more}: {then}"
    elif len(steps) and find_unseen(time.tolist(), float(time[0]), float(time[-1])):
        yield (
            f"{len(steps) / (time[-1] - time[0]):.1f} frames a second are too few: a salute may be "
            "missed between two of them; film at ten and more"
        )
