"""Traversals: the ways to run through one figure, by direction, starting point or exchanged sides.

People begin a circle at the top or at the side and draw it either way round; a line is drawn from
either end. A pose model may exchange left and right throughout a take. Unless the language needs
the difference, all traversals are the same gesture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition.features.motion import STEPS, Movement

BACKWARD_PENALTY = 2.0
"""Factor on the distances to a gesture traversed backwards.

People keep the demonstrated direction more often than they reverse it. On other people's digits
and commands the accuracy is the same from 1.2 to 2; with 1.4, 5 points fewer of the figures of
`utd_signals` are right.
"""

EXCHANGED_PENALTY = 1.5
"""Factor on the distances to a gesture with exchanged sides.

One in fourteen recorded two-handed figures has left and right exchanged throughout. They are
recognised with factors from 1.4 to 1.7; with 3, three in a hundred of all takes are not.
"""

STARTS = 8
"""Starting points of a closed figure: every eighth of its path; the DTW band of a quarter covers
what lies between."""

MAX_OPENING = 0.3
"""Widest gap between start and end of a closed figure, as a share of its extent: people end a
circle in the air up to a fifth of its diameter from its start, a 9 or a 6 up to half."""

MIN_BREADTH = 0.25
"""Least mean distance between the first and second half of a closed figure, as a share of its
extent: a line drawn to and fro ends where it began and is no loop."""


@dataclass(frozen=True, eq=False)
class Traversal:
    """One way to run through a movement.

    Attributes
    ----------
    order
        ``(STEPS,)`` indices of the steps.
    backward
        Whether the direction is reversed.
    exchanged
        Whether left and right are exchanged.
    either_way
        Whether the author has said that the direction does not count: backwards is as good.

    """

    order: npt.NDArray[np.intp]
    backward: bool = False
    exchanged: bool = False
    either_way: bool = False

    @property
    def penalty(self) -> float:
        """Factor on the distances of this traversal."""
        return (BACKWARD_PENALTY if self.backward and not self.either_way else 1.0) * (
            EXCHANGED_PENALTY if self.exchanged else 1.0
        )

    def of(self, movement: Movement, landmarks: Sequence[str]) -> Movement:
        """Return a movement in this traversal; `landmarks` are the names of its paths."""
        ordered = movement.reorder(self.order)
        return ordered.with_sides_exchanged(landmarks) if self.exchanged else ordered


AS_SHOWN = Traversal(np.arange(STEPS))
SIDES_EXCHANGED = Traversal(AS_SHOWN.order, exchanged=True)


def list_traversals(
    movement: Movement,
    *,
    hands: int,
    both_ways: bool,
    either_way: bool = False,
    either_side: bool = False,
) -> tuple[Traversal, ...]:
    """Return the traversals of a gesture, first the one that was demonstrated.

    Parameters
    ----------
    movement
        The demonstration.
    hands
        How many parts of the body move independently, see `find_hands`. Only figures of one are
        reordered: with two hands, opening is the reverse of closing.
    both_ways
        Whether it may be traversed backwards.
    either_way
        Whether backwards is as good as forwards, by the author's switch.
    either_side
        Whether left and right may have been exchanged.

    """
    if hands != 1:
        return (AS_SHOWN, SIDES_EXCHANGED) if either_side else (AS_SHOWN,)
    starts = range(STARTS) if is_closed(movement) else range(1)
    rolls = [np.roll(AS_SHOWN.order, -start * STEPS // STARTS) for start in starts]
    forward = [AS_SHOWN] + [Traversal(order) for order in rolls[1:]]
    backward = (
        [Traversal(order[::-1], backward=True, either_way=either_way) for order in rolls]
        if both_ways
        else []
    )
    return (*forward, *backward)


def is_closed(movement: Movement) -> bool:
    """Return whether a movement ends near its start and encloses an area."""
    paths = movement.paths
    extent = float(np.linalg.norm(np.ptp(paths, axis=0)))
    opening = float(np.linalg.norm(paths[0] - paths[-1]))
    breadth = float(np.sqrt(((paths - paths[::-1]) ** 2).sum(axis=(1, 2))).mean())
    return opening < MAX_OPENING * extent and breadth > MIN_BREADTH * extent
