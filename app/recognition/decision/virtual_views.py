"""Virtual views: demonstrations rotated to the facing of the diver in the query.

A camera sees a gesture differently when the diver is turned. A demonstration with depth is turned
by the angle between the two divers, and compared as the camera would see it then. Depth itself is
never compared: the depth of a pose model is too noisy for that.
"""

from __future__ import annotations

import numpy as np

from app.recognition.decision.references import References

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


def list_views(references: References, facing: float | None) -> list[References]:
    """Return the references as seen in the views that a query is compared with.

    Parameters
    ----------
    references
        As demonstrated.
    facing
        `Trajectory.facing` of the query. Where it is None but demonstrations have depth, all turns
        are listed, because the diver may face any direction.

    """
    trajectories = [each.trajectory for each in references.shown]
    facings = [None if each is None else each.facing for each in trajectories]
    if all(each is None for each in facings):
        return [references]
    if facing is not None:
        rounded = PRECISION * round(facing / PRECISION)
        return [references.turn([choose_turn(rounded, each) for each in facings])]
    return [
        references.turn([0 if each is None else turn for each in facings])
        for turn in sorted(range(-FARTHEST, FARTHEST + 1, STEP), key=abs)
    ]


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
