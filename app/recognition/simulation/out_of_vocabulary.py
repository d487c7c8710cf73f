"""Out-of-vocabulary movements, simulated: what a diver may show that is no gesture of a language.

Background motion (`background_motion`), and splices: the first half of one gesture followed by the
second half of another one.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from app.recognition.gestures.demonstration import condense
from app.recognition.gestures.gesture import Gesture
from app.recognition.poses.trajectory import Trajectory
from app.recognition.simulation.background_motion import simulate_background_motion

MOST_SPLICES = 16
"""Most splices of a language, as many as there are kinds of background motion."""


def draw_out_of_vocabulary(gestures: Sequence[Gesture]) -> tuple[Trajectory, ...]:
    """Return movements that are no gesture of the language: background motion, then splices.

    All of them are condensed, as queries are.
    """
    shown = [
        gesture.trajectory
        for gesture in gestures
        if gesture.trajectory is not None and not gesture.is_held
    ]
    return _draw_background_motion() + tuple(map(condense, splice_all(shown)))


@lru_cache(maxsize=1)
def _draw_background_motion() -> tuple[Trajectory, ...]:
    return tuple(condense(movement.trajectory) for movement in simulate_background_motion(1))


def splice_all(demonstrations: Sequence[Trajectory]) -> tuple[Trajectory, ...]:
    """Splice each demonstration with the next one, at most `MOST_SPLICES` of them."""
    following = (*demonstrations[1:], *demonstrations[:1])
    return tuple(
        splice(before, after)
        for before, after in zip(demonstrations, following, strict=True)
        if before is not after
        and min(len(before), len(after)) > 1
        and set(before.landmarks) & set(after.landmarks)
    )[:MOST_SPLICES]


def splice(before: Trajectory, after: Trajectory) -> Trajectory:
    """Join the first half of one movement and the second half of another.

    Parameters
    ----------
    before, after
        At least two moments each; common landmarks are kept. The second half is shifted to be
        continuous; a landmark not seen at the seam is not shifted.

    """
    common = [name for name in before.landmarks if name in after.landmarks]
    head = before.select(common).between(0.0, before.time[-1] / 2)
    tail = after.select(common)
    tail = tail.between(tail.time[-1] / 2, tail.time[-1])
    step = (before.time[-1] - before.time[0]) / (len(before) - 1)
    depth = None
    if head.depth is not None and tail.depth is not None:
        depth = np.concatenate([head.depth, tail.depth])
    return Trajectory(
        landmarks=tuple(common),
        xy=np.concatenate([head.xy, tail.xy + np.nan_to_num(head.xy[-1] - tail.xy[0])]),
        time=np.concatenate([head.time, tail.time - tail.time[0] + head.time[-1] + step]),
        unit=before.unit,
        depth=depth,
    )
