"""Outliers: landmarks that jump farther than an arm can go and come back.

Pose models misplace a landmark for a frame or a few. Between the moments before and after, an arm
can leave the straight line only as far as its acceleration allows.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from app.recognition.poses.landmarks import POSE_LANDMARKS, UPPER_BODY
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory
from app.recognition.preprocessing.salience import measure_displacements

LONGEST_JUMP = 0.25
"""Most seconds between the moments around an outlier. In that time a hand can go half a torso
length and come back (see `ACCELERATION`); longer outliers look like strokes."""

ACCELERATION = 200.0
"""Largest acceleration, torso lengths a second squared: about 100 m/s^2, that of a hand that throws
or swings a racket. With half of it, strokes of other people's throws were taken for errors, half
of all recordings of `utd_other` lost some, and 1 to 4 points of accuracy with them; jumps of a pose
model are found as before (`benchmarks/studies/people.md`)."""

NOTICED = 0.15
"""Least distance of an outlier, torso lengths (7 cm); smaller ones are smoothed as jitter."""

JITTERS = 9.0
"""Least distance of an outlier as a multiple of the lower quartile of the landmark's distances, so
that trembling is no outlier. The quartile, because outliers also affect the moments beside them."""

MOST_JUMPS = 0.25
"""Largest share of a landmark's moments that may be outliers. With more, the true positions cannot
be determined, and all are kept."""

TORSOS_PER_EXTENT = 0.7
"""Torso lengths per largest displacement of a landmark, where no torso is in view: gestures of an
arm span one to two."""

UNFOLLOWED = frozenset(POSE_LANDMARKS) - UPPER_BODY

Mask: TypeAlias = npt.NDArray[np.bool_]


def find_outliers(trajectory: Trajectory) -> Mask:
    """Find the outliers of a trajectory.

    Returns
    -------
    ``(T, K)``: which landmark is misplaced at which moment. Never the first and the last moment at
    which it is seen, which have no neighbour on one side, nor MediaPipe's legs and details of the
    face, which no gesture uses.

    """
    off = np.zeros(trajectory.xy.shape[:2], dtype=bool)
    followed = _find_followed(trajectory.landmarks)
    paths = trajectory.xy.take(followed, axis=1)
    if (unit := measure_body_unit(trajectory)) != 1.0:
        paths /= unit
    finite, kinked = np.isfinite(paths), _has_kink(paths)
    if finite.all() and not kinked.any():
        return off
    known = np.asarray(finite[..., 0] & finite[..., 1])
    whole: Mask = np.asarray(known.all(axis=0))
    together = np.flatnonzero(whole & kinked)
    if len(together):
        off[:, followed[together]] = _find_strays(paths.take(together, axis=1), trajectory.time)
    for index in np.flatnonzero(~whole).tolist():
        seen = np.flatnonzero(known[:, index])
        path = paths[seen, index, None]
        if _has_kink(path).any():
            off[seen, followed[index]] = _find_strays(path, trajectory.time[seen])[:, 0]
    return off


@lru_cache(maxsize=64)
def _find_followed(landmarks: tuple[str, ...]) -> npt.NDArray[np.intp]:
    """Return the indices of the landmarks that a gesture may follow."""
    return np.flatnonzero([name not in UNFOLLOWED for name in landmarks])


def _has_kink(paths: FloatArray) -> Mask:
    """Return ``(K,)``: in which of paths ``(T, K, 2)``, without gaps, a step differs from the last.

    By more than `NOTICED`, as at every outlier. At thirty frames a second no movement has such
    steps, which makes this a fast first test.
    """
    steps = paths[1:] - paths[:-1]
    bends = steps[1:] - steps[:-1]
    np.multiply(bends, bends, out=bends)
    squares = bends[..., 0] + bends[..., 1]
    return np.asarray(squares.max(axis=0, initial=0) > NOTICED**2)


def measure_body_unit(trajectory: Trajectory) -> float:
    """Return a torso length, or an estimate of it, in the trajectory's unit; > 0."""
    if trajectory.unit == "torso_length":
        return 1.0
    return TORSOS_PER_EXTENT * max(measure_displacements(trajectory).values()) or 1.0


def _find_strays(paths: FloatArray, time: FloatArray) -> Mask:
    """Return ``(T, K)``: the outliers of paths ``(T, K, 2)`` in torso lengths."""
    off = _find_clearest(paths, time)
    for index in np.flatnonzero(off.any(axis=0)).tolist():
        off[:, index] = _find_further(off[:, index], paths[:, [index]], time)
    return off


def _find_further(off: Mask, path: FloatArray, time: FloatArray) -> Mask:
    """Find further outliers of one landmark after removing those found, until there are none.

    Returns
    -------
    ``(T,)``; none at all if there are more than `MOST_JUMPS`.

    """
    while off.mean() <= MOST_JUMPS:
        kept = np.flatnonzero(~off)
        found = _find_clearest(path[kept], time[kept])[:, 0]
        if not found.any():
            return off
        off[kept[found]] = True
    return np.zeros_like(off)


def _find_clearest(paths: FloatArray, time: FloatArray) -> Mask:
    """Find each landmark's clearest outliers, of one or more moments, without adjacent ones.

    Parameters
    ----------
    paths
        ``(T, K, 2)`` without gaps, in torso lengths.
    time
        ``(T,)`` seconds.

    Returns
    -------
    ``(T, K)``.

    """
    candidates: list[tuple[float, int, int, int]] = []
    usual = np.zeros(paths.shape[1])
    for length in range(1, len(paths) - 1):
        firsts = len(paths) - length - 1
        lasts = time[length + 1 :] - time[:firsts]
        if lasts.min() > LONGEST_JUMP:
            break
        net = paths[length + 1 :] - paths[:firsts]
        stray = _measure_least_stray(paths, time, net, lasts)
        if length == 1:
            usual = _lower_quartile(stray)
        carried = NOTICED + ACCELERATION / 8 * lasts**2
        allowed = np.maximum(carried[:, None], np.hypot(net[..., 0], net[..., 1]))
        excess = stray - np.maximum(allowed, JITTERS * usual)
        excess[lasts > LONGEST_JUMP] = 0.0
        for start, index in np.argwhere(excess > 0).tolist():
            candidates.append((float(excess[start, index]), start, start + length + 1, index))
    touched, off = np.zeros(paths.shape[:2], dtype=bool), np.zeros(paths.shape[:2], dtype=bool)
    for _, start, end, index in sorted(candidates, reverse=True):
        if not touched[start : end + 1, index].any():
            touched[start : end + 1, index] = True
            off[start + 1 : end, index] = True
    return off


def _lower_quartile(values: FloatArray) -> FloatArray:
    """Return ``np.quantile(values, 0.25, axis=0)`` in a fifth of the time."""
    place = (len(values) - 1) / 4
    below, above = int(place), math.ceil(place)
    ordered = np.partition(values, (below, above), axis=0)
    return np.asarray(ordered[below] + (place - below) * (ordered[above] - ordered[below]))


def _measure_least_stray(
    paths: FloatArray, time: FloatArray, net: FloatArray, lasts: FloatArray
) -> FloatArray:
    """Compute the least distance from the straight line of the positions between two moments.

    Parameters
    ----------
    paths, time
        As for `_find_clearest`.
    net, lasts
        ``(F, K, 2)`` and ``(F,)``: displacement and seconds between each of the first F moments
        and the one that is ``T - F`` later.

    Returns
    -------
    ``(F, K)``: the smallest distance of a position in between from that of uniform motion.

    """
    firsts = len(lasts)
    least = np.full(net.shape[:2], np.inf)
    for between in range(1, len(paths) - firsts):
        share = (time[between : between + firsts] - time[:firsts]) / lasts
        away = paths[between : between + firsts] - paths[:firsts] - share[:, None, None] * net
        np.minimum(least, np.hypot(away[..., 0], away[..., 1]), out=least)
    return least
