"""Jumps: moments at which a landmark lies where no arm could have carried it there and back.

A pose model throws a landmark onto something else for a frame or a few, and finds it again.
Between the moments before and after, an arm can only stray from the straight line as far as its
acceleration allows; what strays farther was misplaced.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from app.recognition.landmarks import POSE_LANDMARKS, UPPER_BODY
from app.recognition.poses import FloatArray
from app.recognition.salience import displacements
from app.recognition.trajectory import Trajectory

LONGEST_JUMP = 0.25
"""Seconds between the moments around a jump, at most. In that time a hand can go half a torso
length and come back (see `ACCELERATION`); beyond, a jump and a stroke cannot be told apart."""

ACCELERATION = 100.0
"""Torso lengths a second squared, about 50 m/s^2: of a fast pointing hand in air it is half of
that, in water less."""

NOTICED = 0.15
"""Torso lengths, 7 cm: what strays less is jitter, which smoothing takes care of."""

JITTERS = 9.0
"""How many times the lower quartile of the landmark's strays a jump must be: in a recording that
trembles all over, no moment is worse than the others. The quartile, since a jump in every fifth
moment also puts the moments beside it off the line."""

MOST_JUMPS = 0.25
"""Share of a landmark's moments that may be jumps. Where there are more, nobody knows which of its
places are the true ones, and all are left as they are."""

TORSOS_PER_EXTENT = 0.7
"""Torso lengths in the largest displacement of a landmark, where no torso is in view: gestures of
an arm span one to two."""

UNFOLLOWED = frozenset(POSE_LANDMARKS) - UPPER_BODY

Mask = npt.NDArray[np.bool_]


def jumps(trajectory: Trajectory) -> Mask:
    """Find where landmarks jump.

    Returns
    -------
    ``(T, K)``: which landmark is misplaced at which moment. The first and the last moment at which
    it is seen never are: there is no there and back. Nor are MediaPipe's legs and the details of
    the face, which no gesture follows.

    """
    off = np.zeros(trajectory.xy.shape[:2], dtype=bool)
    followed = _followed(trajectory.landmarks)
    paths = trajectory.xy.take(followed, axis=1) / body_unit(trajectory)
    finite = np.isfinite(paths)
    known = np.asarray(finite[..., 0] & finite[..., 1])
    with_gaps: Mask = ~np.asarray(known.all(axis=0))
    for index in np.flatnonzero(with_gaps | _has_kink(paths)).tolist():
        seen = np.flatnonzero(known[:, index])
        if with_gaps[index] and not _has_kink(paths[seen, index, None]).any():
            continue
        off[seen, followed[index]] = _strays(paths[seen, index], trajectory.time[seen])
    return off


@lru_cache(maxsize=64)
def _followed(landmarks: tuple[str, ...]) -> npt.NDArray[np.intp]:
    """Return the places of the landmarks that a gesture may follow."""
    return np.flatnonzero([name not in UNFOLLOWED for name in landmarks])


def _has_kink(paths: FloatArray) -> Mask:
    """Tell ``(K,)`` in which of paths ``(T, K, 2)``, without gaps, a step differs from the last.

    By more than `NOTICED`, as every jump's does. At thirty frames a second no movement's do; then
    nothing else need be looked at.
    """
    steps = paths[1:] - paths[:-1]
    bends = steps[1:] - steps[:-1]
    squares = bends[..., 0] ** 2 + bends[..., 1] ** 2
    return np.asarray(squares.max(axis=0, initial=0) > NOTICED**2)


def body_unit(trajectory: Trajectory) -> float:
    """Return a torso length, or what stands in for it, in the trajectory's unit; > 0."""
    if trajectory.unit == "torso_length":
        return 1.0
    return TORSOS_PER_EXTENT * max(displacements(trajectory).values()) or 1.0


def _strays(path: FloatArray, time: FloatArray) -> Mask:
    """Tell ``(T,)`` which places of one landmark's path ``(T, 2)``, in torso lengths, are jumps."""
    off = np.zeros(len(path), dtype=bool)
    while True:
        kept = np.flatnonzero(~off)
        found = _there_and_back(path[kept], time[kept])
        if not found.any():
            return off
        off[kept[found]] = True
        if off.mean() > MOST_JUMPS:
            return np.zeros(len(path), dtype=bool)


def _there_and_back(path: FloatArray, time: FloatArray) -> Mask:
    """Find the clearest jumps, of one or more moments each, that do not touch one another."""
    candidates: list[tuple[float, int, int]] = []
    usual = 0.0
    for length in range(1, len(path) - 1):
        first = np.arange(len(path) - length - 1)
        last = first + length + 1
        lasts = time[last] - time[first]
        if lasts.min() > LONGEST_JUMP:
            break
        inside = first[:, None] + np.arange(1, length + 1)
        share = (time[inside] - time[first, None]) / lasts[:, None]
        net = path[last] - path[first]
        line = path[first, None] + share[..., None] * net[:, None]
        stray = np.linalg.norm(path[inside] - line, axis=2).min(axis=1)
        if length == 1:
            usual = float(np.quantile(stray, 0.25))
        allowed = np.maximum(NOTICED + ACCELERATION / 8 * lasts**2, np.linalg.norm(net, axis=1))
        excess = stray - np.maximum(allowed, JITTERS * usual)
        for start in np.flatnonzero((excess > 0) & (lasts <= LONGEST_JUMP)).tolist():
            candidates.append((float(excess[start]), start, start + length + 1))
    touched, off = np.zeros(len(path), dtype=bool), np.zeros(len(path), dtype=bool)
    for _, start, end in sorted(candidates, reverse=True):
        if not touched[start : end + 1].any():
            touched[start : end + 1] = True
            off[start + 1 : end] = True
    return off
