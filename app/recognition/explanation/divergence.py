"""Divergence: the stretch and joint at which two aligned movements differ most."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.recognition.explanation.alignment import Alignment
from app.recognition.features.motion import STEPS
from app.recognition.poses.sequence import FloatArray

DIRECTIONS = (
    "right",
    "down and right",
    "down",
    "down and left",
    "left",
    "up and left",
    "up",
    "up and right",
)
"""Directions in steps of an eighth of a turn, from the x axis, x to the right, y down."""

STANDS = 0.15
"""Net displacement, as a share of the gesture's extent, below which a joint goes nowhere: it turns
or rests; the shortest side of a figure is larger."""


LEAST_STRETCH = STEPS // 8
"""Least steps of a stretch, the shortest stroke."""


@dataclass(frozen=True, kw_only=True)
class Divergence:
    """The stretch at which a query differs most from a gesture.

    Attributes
    ----------
    landmark
        The joint with the largest cost there.
    start, end
        Seconds in the query's clock.
    share
        Share of the whole cost between the two.
    shown, expected
        Movement of the joint there in the query and in the gesture: a verb and a direction.

    """

    landmark: str
    start: float
    end: float
    share: float
    shown: str
    expected: str


def measure_divergence(alignment: Alignment, query: FloatArray, gesture: FloatArray) -> Divergence:
    """Find the divergence of two paths ``(N, L, 2)`` along their alignment."""
    costs = alignment.over_time
    first, last = find_costliest_stretch(costs.sum(axis=1))
    joint = int(costs[first : last + 1].sum(axis=0).argmax())
    steps = alignment.pairs[:, 0]
    partners = alignment.pairs[(steps >= first) & (steps <= last), 1]
    return Divergence(
        landmark=alignment.parts[joint],
        start=float(alignment.time[first]),
        end=float(alignment.time[last]),
        share=float(costs[first : last + 1].sum() / max(costs.sum(), 1e-12)),
        shown=_way(query[:, joint], first, last),
        expected=_way(gesture[:, joint], int(partners[0]), int(partners[-1])),
    )


def find_costliest_stretch(costs: FloatArray) -> tuple[int, int]:
    """Return the first and last step of the stretch whose costs most exceed the average.

    It is the contiguous run with the largest sum of costs minus their mean (Bentley 1984), widened
    to `LEAST_STRETCH` if there are that many steps.
    """
    excess = costs - costs.mean()
    best, span = -np.inf, (0, len(costs) - 1)
    total, first = 0.0, 0
    for step, value in enumerate(excess.tolist()):
        if total <= 0:
            total, first = 0.0, step
        total += value
        if total > best:
            best, span = total, (first, step)
    first = min(span[0], max(0, len(costs) - LEAST_STRETCH))
    return first, min(max(span[1], first + LEAST_STRETCH - 1), len(costs) - 1)


def _way(path: FloatArray, first: int, last: int) -> str:
    """Return the direction of a path ``(N, 2)`` between two steps in words."""
    # One step more on either side: a stretch of a single step has a direction too.
    way = path[min(last + 1, len(path) - 1)] - path[max(first - 1, 0)]
    if np.hypot(*way) < STANDS * np.hypot(*np.ptp(path, axis=0)):
        return "goes nowhere"
    eighth = round(float(np.arctan2(way[1], way[0])) / (np.pi / 4)) % 8
    return f"goes {DIRECTIONS[eighth]}"
