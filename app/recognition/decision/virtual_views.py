"""Virtual views: demonstrations rotated to the facing of the diver in the query.

A camera sees a gesture differently when the diver is turned. A demonstration with depth is turned
by the angle between the two divers, and compared as the camera would see it then. Depth itself is
never compared: the depth of a pose model is too noisy for that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from app.recognition.decision.motion_references import MotionReferences
from app.recognition.gestures.gesture import Gesture

STEP = 30
"""Degrees between views: DTW tolerates the up to 15 degrees from the nearest view; steps of 15
degrees changed no result by more than sampling error (`benchmarks/studies/views.md`)."""

FARTHEST = 60
"""Largest turn of a view in degrees: beyond, one shoulder hides the other."""

PRECISION = 10
"""Degrees to which the query's turn is rounded: about the precision of a pose model's depth, so
that a dive has few views."""

SIDEWAYS = 105
"""Degrees from which a diver counts as not turned: seen from behind, left and right are uncertain.
"""

CACHED = 8
"""Number of cached views of one language: a dive has a few, each of up to ten megabytes."""

Turns = tuple[int, ...]
"""Degrees by which each of S references is turned, multiples of `STEP`."""


@dataclass(frozen=True, eq=False)
class View:
    """The references of a language as seen when each is turned.

    Attributes
    ----------
    turns
        ``(S,)`` degrees by which each reference is turned, positive to the body's own left.
    motions
        The turned references.

    """

    turns: npt.NDArray[np.intp]
    motions: MotionReferences


class Views:
    """The views of a language, made when first needed.

    Parameters
    ----------
    gestures
        S gestures of one demonstration each.
    motions
        Their references as demonstrated.

    """

    def __init__(self, gestures: Sequence[Gesture], motions: MotionReferences) -> None:
        self._gestures = tuple(gestures)
        self._facings = tuple(
            None if each.trajectory is None else each.trajectory.facing for each in gestures
        )
        self._as_shown = View(np.zeros(len(self._gestures), dtype=np.intp), motions)
        self._made: dict[Turns, View] = {}

    def list_for(self, facing: float | None) -> list[View]:
        """Return the views that a query is compared with.

        Parameters
        ----------
        facing
            `Trajectory.facing` of the query. Where it is None but demonstrations have depth, all
            turns are listed, because the diver may face any direction.

        """
        if all(each is None for each in self._facings):
            return [self._as_shown]
        if facing is not None:
            rounded = PRECISION * round(facing / PRECISION)
            return [self._view(tuple(choose_turn(rounded, each) for each in self._facings))]
        return [
            self._view(tuple(0 if each is None else turn for each in self._facings))
            for turn in sorted(range(-FARTHEST, FARTHEST + 1, STEP), key=abs)
        ]

    def _view(self, turns: Turns) -> View:
        if not any(turns):
            return self._as_shown
        if (made := self._made.get(turns)) is None:
            made = View(
                np.array(turns, dtype=np.intp), self._as_shown.motions.turn(self._gestures, turns)
            )
            # Replaced, never changed: several threads may recognise with one recogniser.
            kept = list(self._made.items())[-(CACHED - 1) :]
            self._made = dict([*kept, (turns, made)])
        return made


def choose_turn(query: float, reference: float | None) -> int:
    """Return the degrees by which a reference is turned to face as a query does.

    Parameters
    ----------
    query, reference
        Degrees by which each is turned from the camera; None: not known.

    """
    if reference is None:
        return 0
    between = (query - reference + 180.0) % 360.0 - 180.0
    if abs(between) > SIDEWAYS:
        return 0
    return int(np.clip(round(between / STEP) * STEP, -FARTHEST, FARTHEST))
