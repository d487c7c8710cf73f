"""Readings: the ways in which the same figure may be drawn, or seen.

Asked for a circle, people begin at the top or at the side, and go round either way; a line is
drawn from either end. Of a figure of both hands, a tracker may take the left for the right from
the first frame to the last. Unless the language needs the difference, all of them are the same
gesture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition.features.motion import STEPS, Movement

BACKWARD_PENALTY = 1.5
"""Factor on the distances to a gesture read backwards.

People repeat the way they were shown more often than they turn it round, so among two gestures
about as near the one in its own direction wins. On other people's digits and commands the
accuracy is flat from 1.2 to 2 and falls beyond.
"""

EXCHANGED_PENALTY = 2.0
"""Factor on the distances to a gesture whose sides are read as exchanged.

Of two-handed figures on file, one in fourteen has left and right exchanged throughout. From 1.5 to
2 they are named right either way; below, spreading wings begins to look like folding them.
"""

STARTS = 8
"""Places at which a closed figure may begin: every eighth of its way; the elastic band of a
quarter covers what lies between."""

MAX_OPENING = 0.3
"""Widest gap between start and end of a closed figure, as a share of its extent: people miss
the start of a circle drawn in the air by up to a fifth of its diameter, that of a 9 or a 6 by
half."""

MIN_BREADTH = 0.25
"""Least mean distance between the way out and the way back of a closed figure, as a share of its
extent: a line drawn to and fro ends where it began and is no loop."""


@dataclass(frozen=True, eq=False)
class Traversal:
    """One way in which a movement may be read.

    Attributes
    ----------
    order
        ``(STEPS,)`` indices of the steps.
    backward
        Whether the direction is turned round.
    exchanged
        Whether what the left hand does is taken for the right one's, and the other way round.

    """

    order: npt.NDArray[np.intp]
    backward: bool = False
    exchanged: bool = False

    @property
    def penalty(self) -> float:
        """Factor on the distances of this traversal."""
        return (BACKWARD_PENALTY if self.backward else 1.0) * (
            EXCHANGED_PENALTY if self.exchanged else 1.0
        )

    def of(self, movement: Movement, landmarks: Sequence[str]) -> Movement:
        """Read a movement, whose paths are of the named landmarks, in this way."""
        ordered = movement.reordered(self.order)
        return ordered.with_sides_exchanged(landmarks) if self.exchanged else ordered


AS_SHOWN = Traversal(np.arange(STEPS))
SIDES_EXCHANGED = Traversal(AS_SHOWN.order, exchanged=True)


def list_traversals(
    movement: Movement, *, hands: int, both_ways: bool, either_side: bool = False
) -> tuple[Traversal, ...]:
    """Return the traversals of a gesture: as shown first.

    Parameters
    ----------
    movement
        The demonstration.
    hands
        How many parts of the body move by themselves, see `find_hands`. Only a figure of one is
        read in another order: with two hands, opening is the reverse of closing.
    both_ways
        Whether it may be read backwards.
    either_side
        Whether left and right may have been exchanged.

    """
    if hands != 1:
        return (AS_SHOWN, SIDES_EXCHANGED) if either_side else (AS_SHOWN,)
    starts = range(STARTS) if is_closed(movement) else range(1)
    rolls = [np.roll(AS_SHOWN.order, -start * STEPS // STARTS) for start in starts]
    forward = [AS_SHOWN] + [Traversal(order) for order in rolls[1:]]
    backward = [Traversal(order[::-1], backward=True) for order in rolls] if both_ways else []
    return (*forward, *backward)


def is_closed(movement: Movement) -> bool:
    """Tell whether a movement ends where it began, and encloses something."""
    paths = movement.paths
    extent = float(np.linalg.norm(np.ptp(paths, axis=0)))
    opening = float(np.linalg.norm(paths[0] - paths[-1]))
    breadth = float(np.sqrt(((paths - paths[::-1]) ** 2).sum(axis=(1, 2))).mean())
    return opening < MAX_OPENING * extent and breadth > MIN_BREADTH * extent
