"""Cuts: the take without its first or its last stroke, which may be the way from or to a salute."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from app.recognition.explanation.context import RecognitionContext
from app.recognition.explanation.strokes import Piece
from app.recognition.gestures.demonstration import MIN_FRAMES
from app.recognition.poses.sequence import PoseSequence


@dataclass(frozen=True, eq=False)
class Cut:
    """A take without one of its strokes.

    Attributes
    ----------
    where
        At which end it is.
    stroke
        What is left out.
    poses
        The rest.

    """

    where: Literal["start", "end"]
    stroke: Piece
    poses: PoseSequence


def find_cuts(context: RecognitionContext) -> Iterator[Cut]:
    """Yield the take without its first and without its last stroke; a way is straight."""
    told = [each for each in context.strokes if each.kind != "pause"]
    if len({each.hand for each in told}) != 1 or len(told) < 3:
        return
    start, end = float(context.poses.time[0]), float(context.poses.time[-1])
    ends: tuple[tuple[Literal["start", "end"], Piece, float, float], ...] = (
        ("start", told[0], told[1].start, end),
        ("end", told[-1], start, told[-2].end),
    )
    for where, stroke, first, last in ends:
        poses = context.poses.between(first, last)
        if stroke.kind == "line" and len(poses) >= MIN_FRAMES:
            yield Cut(where, stroke, poses)
