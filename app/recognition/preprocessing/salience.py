"""Salient landmarks: chooses the few landmarks whose motion is the gesture (paper, Sec. IV-A)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from app.recognition.errors import GestureError
from app.recognition.poses.landmarks import LANDMARK_GROUPS, POSE_LANDMARKS, SHOULDERS, TORSO
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory

MIN_DISPLACEMENT = 0.3
"""Peak-to-peak displacement, in the trajectory's unit, from which a landmark can be salient.

About 15 cm. A resting hand and the head move up to 0.2 torso lengths (balance, breathing, jitter);
the smallest deliberate arm gestures span half a torso length and more.
"""

MIN_SHARE_OF_LARGEST = 0.4
"""Least displacement of a salient landmark as a share of the largest one.

A diver's idle hand sculls for balance, more so during wide gestures, so a fixed threshold is not
enough. In two-handed recordings the smaller displacement is rarely below half of the larger.
"""

LEAST_DISPLACEMENT = 0.2
"""Displacement below which nothing moves at all: a pose model's jitter, an idle hand.

Between it and `MIN_DISPLACEMENT` a gesture is accepted, such as one towards the camera, and the
health check warns that it is small.
"""

OUTLIER_PERCENTILES = (5.0, 95.0)
"""The percentiles taken as peak to peak.

One frame with a misplaced landmark would make it salient. Real extremes are slow, because the hand
turns round there, so little of them is lost.
"""

_GROUP_OF = {name: group for group, names in LANDMARK_GROUPS.items() for name in names}

_JOINTS = frozenset({*SHOULDERS, "left_elbow", "right_elbow"})
"""Joints of the upper body that are salient only where no hand and no head moves."""

_NEVER_SALIENT = frozenset({*POSE_LANDMARKS, TORSO}) - frozenset(_GROUP_OF)
"""MediaPipe's arms, trunk and legs.

Hips are the frame of reference, and legs swim: only the author can choose them. Elbows follow the
hands: they count where no hand moves (`_JOINTS`).
"""


def measure_displacements(trajectory: Trajectory) -> dict[str, float]:
    """Measure how far each landmark moves, peak to peak.

    Parameters
    ----------
    trajectory
        The demonstration, relative to the torso.

    Returns
    -------
    Per landmark name the diagonal of the box around its path (between `OUTLIER_PERCENTILES`),
    in the trajectory's unit; 0 for a landmark that is never seen.

    """
    seen: npt.NDArray[np.bool_] = np.asarray(np.isfinite(trajectory.xy).all(axis=2))
    extents = np.zeros(len(trajectory.landmarks))
    # Most landmarks are seen all the time, and measured at once in the time of one.
    always = seen.all(axis=0)
    if always.any() and len(seen):
        extents[always] = _measure_extents(trajectory.xy[:, always])
    for index in np.flatnonzero(seen.any(axis=0) & ~always):
        extents[index] = _measure_extents(trajectory.xy[seen[:, index], index])
    return dict(zip(trajectory.landmarks, extents.tolist(), strict=True))


def _measure_extents(paths: FloatArray) -> FloatArray:
    """Return the diagonals of the boxes around paths ``(T, ..., 2)``, ``(...)``."""
    low, high = np.percentile(paths, OUTLIER_PERCENTILES, axis=0)
    size = high - low
    return np.asarray(np.hypot(size[..., 0], size[..., 1]))


def find_salient_landmarks(trajectory: Trajectory) -> tuple[str, ...]:
    """Choose the landmarks whose motion is the gesture.

    At most one of each hand and one of the head (`LANDMARK_GROUPS`): the group's usual
    representative if available, so that all recordings use the same one. Landmarks of other sets
    than MediaPipe's are not grouped.

    Where none of them moves by `MIN_DISPLACEMENT`, an elbow or a shoulder may carry the gesture;
    where none of these does either, the landmarks that move most, from `LEAST_DISPLACEMENT`.

    Returns
    -------
    Names in the trajectory's order; empty when nothing moves.

    """
    moved = _eligible_displacements(trajectory)
    bar = _find_bar(moved)
    chosen = {name for name, displacement in moved.items() if displacement >= bar}
    if not chosen:
        chosen = _find_other_moving(trajectory, moved)
    return tuple(name for name in trajectory.landmarks if name in chosen)


def _find_other_moving(trajectory: Trajectory, hands: Mapping[str, float]) -> set[str]:
    """Return the landmarks that carry a gesture in which no hand or head moves far."""
    joints = {
        name: moved for name, moved in measure_displacements(trajectory).items() if name in _JOINTS
    }
    for moved, least in ((joints, MIN_DISPLACEMENT), (joints | {**hands}, LEAST_DISPLACEMENT)):
        largest = max(moved.values(), default=0.0)
        if largest >= least:
            bar = max(least, MIN_SHARE_OF_LARGEST * largest)
            return {name for name, displacement in moved.items() if displacement >= bar}
    return set()


def find_least_displacement(trajectory: Trajectory) -> float:
    """Return the least displacement of a salient landmark, in the trajectory's unit."""
    return _find_bar(_eligible_displacements(trajectory))


def _find_bar(moved: Mapping[str, float]) -> float:
    return max(MIN_DISPLACEMENT, MIN_SHARE_OF_LARGEST * max(moved.values(), default=0.0))


def choose_landmarks(trajectory: Trajectory, salient: Sequence[str]) -> tuple[str, ...]:
    """Check landmarks that the author chose in place of `find_salient_landmarks`.

    Returns
    -------
    The names in the trajectory's order.

    Raises
    ------
    GestureError
        When the choice is empty, or names a landmark twice, one that is missing, or one that is
        never seen.

    """
    names = tuple(salient)
    if isinstance(salient, str) or not names:
        raise GestureError(f"salient must be one or more landmark names, got {salient!r}")
    if len(set(names)) < len(names):
        raise GestureError(f"salient names a landmark twice: {names}")
    for name in names:
        if name not in trajectory.landmarks:
            raise GestureError(
                f"salient landmark {name!r} is not in this recording; it has "
                f"{', '.join(trajectory.landmarks)}"
            )
        if not np.isfinite(trajectory.select([name]).xy).any():
            raise GestureError(
                f"salient landmark {name!r} is never seen in this recording; choose another one"
            )
    return tuple(name for name in trajectory.landmarks if name in names)


def _eligible_displacements(trajectory: Trajectory) -> dict[str, float]:
    """Return the displacements of the landmarks that `find_salient_landmarks` chooses from."""
    eligible = choose_representatives(trajectory)
    moved = measure_displacements(trajectory)
    return {name: displacement for name, displacement in moved.items() if name in eligible}


def choose_representatives(trajectory: Trajectory) -> frozenset[str]:
    """Return the landmarks that may be salient: one per group, and those outside any group.

    Only landmarks that are seen at all.
    """
    visible = [
        name
        for index, name in enumerate(trajectory.landmarks)
        if np.isfinite(trajectory.xy[:, index]).any()
    ]
    alone = {name for name in visible if name not in _GROUP_OF and name not in _NEVER_SALIENT}
    first = {
        next(name for name in names if name in visible)
        for names in LANDMARK_GROUPS.values()
        if not set(names).isdisjoint(visible)
    }
    return frozenset(alone | first)
