"""Outliers and jumps: landmarks that a pose model has misplaced, or found on another body.

`find_outliers` finds landmarks that jump farther than an arm can go and come back. Pose models
misplace a landmark for a frame or a few. Between the moments before and after, an arm can leave the
straight line only as far as its acceleration allows, and less far if it goes on as if it had not
left.

Repair removes outliers of at most a quarter of a second. What is left and still leaps farther than
any hand moves in a frame is found by `find_leaps` and `find_unsteady`, and moments that show
another body by `find_other_body`, for explanations and for faults of demonstrations.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import combinations
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from app.recognition.poses.landmarks import HIPS, POSE_LANDMARKS, SHOULDERS, TORSO, UPPER_BODY
from app.recognition.poses.sequence import MAX_GAP_SECONDS, FloatArray, fill_all_gaps
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

RETURN_ACCELERATION = 150.0
"""Largest acceleration of a hand that leaves its way, stops, and goes on where it would have been:
less than `ACCELERATION`, and in half the time, as it must also brake. With 100, jumps at 8 frames a
second are missed in 15 of 75 takes, with 150 in 20, but a quick curl of `utd_other` is taken for a
jump and misread (`docs/results.md`)."""

LONGEST_FRAME = 0.41
"""Most seconds around a single misplaced moment: five frames a second."""

BLENDED = 0.08
"""Least distance, torso lengths, by which the moment beside an outlier lies off the line towards
the outlier: pose models smooth, and come back in two steps."""

JITTERS = 9.0
"""Least distance of an outlier as a multiple of the lower quartile of the landmark's distances, so
that trembling is no outlier. The quartile, because outliers also affect the moments beside them."""

MOST_JUMPS = 0.25
"""Largest share of a landmark's moments that may be outliers. With more, the true positions cannot
be determined, and all are kept."""

TORSOS_PER_EXTENT = 0.7
"""Torso lengths per largest displacement of a landmark, where no torso is in view: gestures of an
arm span one to two."""

BODY = frozenset((*SHOULDERS, *HIPS, TORSO))
"""What no arm carries; `repair` needs it where an arm is misplaced."""

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
    reaching = np.array([trajectory.landmarks[each] not in BODY for each in followed], bool)
    known = np.asarray(finite[..., 0] & finite[..., 1])
    whole: Mask = np.asarray(known.all(axis=0))
    together = np.flatnonzero(whole & kinked)
    if len(together):
        off[:, followed[together]] = _find_strays(
            paths.take(together, axis=1), trajectory.time, reaching[together]
        )
    for index in np.flatnonzero(~whole).tolist():
        seen = np.flatnonzero(known[:, index])
        path = paths[seen, index, None]
        if _has_kink(path).any():
            off[seen, followed[index]] = _find_strays(
                path, trajectory.time[seen], reaching[[index]]
            )[:, 0]
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


def _find_strays(paths: FloatArray, time: FloatArray, reaching: Mask) -> Mask:
    """Return ``(T, K)``: the outliers of paths ``(T, K, 2)`` in torso lengths."""
    off = _find_clearest(paths, time, reaching)
    for index in np.flatnonzero(off.any(axis=0)).tolist():
        path = paths[:, index]
        found = _find_further(off[:, index], path[:, None], time, reaching[[index]])
        off[:, index] = found | (_find_blended(found, path, time) & reaching[index])
    return off


def _find_blended(off: Mask, path: FloatArray, time: FloatArray) -> Mask:
    """Return ``(T,)``: the moments beside outliers that lie between these and the true place."""
    blended = np.zeros_like(off)
    for outlier in np.flatnonzero(off).tolist():
        for at in (outlier - 1, outlier + 1):
            ends = [at - 1, at + 1]
            while ends[0] >= 0 and off[ends[0]]:
                ends[0] -= 1
            while ends[1] < len(off) and off[ends[1]]:
                ends[1] += 1
            if off[at] or ends[0] < 0 or ends[1] == len(off):
                continue
            away, jump = (
                path[each] - [np.interp(time[each], time[ends], x) for x in path[ends].T]
                for each in (at, outlier)
            )
            along = float(away @ jump)
            length = float(np.hypot(*away) * np.hypot(*jump))
            blended[at] |= along > 0.9 * length and along > BLENDED * np.hypot(*jump)
    return blended


def _find_further(off: Mask, path: FloatArray, time: FloatArray, reaching: Mask) -> Mask:
    """Find further outliers of one landmark after removing those found, until there are none.

    Returns
    -------
    ``(T,)``; none at all if there are more than `MOST_JUMPS`.

    """
    while off.mean() <= MOST_JUMPS:
        kept = np.flatnonzero(~off)
        found = _find_clearest(path[kept], time[kept], reaching)[:, 0]
        if not found.any():
            return off
        off[kept[found]] = True
    return np.zeros_like(off)


def _find_clearest(paths: FloatArray, time: FloatArray, reaching: Mask) -> Mask:
    """Find each landmark's clearest outliers, of one or more moments, without adjacent ones.

    Parameters
    ----------
    paths
        ``(T, K, 2)`` without gaps, in torso lengths.
    time
        ``(T,)`` seconds.
    reaching
        ``(K,)``: which of them an arm carries, whose return is judged too.

    Returns
    -------
    ``(T, K)``.

    """
    candidates: list[tuple[float, int, int, int]] = []
    usual = np.zeros(paths.shape[1])
    for length in range(1, len(paths) - 1):
        firsts = len(paths) - length - 1
        lasts = time[length + 1 :] - time[:firsts]
        longest = LONGEST_FRAME if length == 1 else LONGEST_JUMP
        if lasts.min() > longest:
            break
        net = paths[length + 1 :] - paths[:firsts]
        stray = _measure_least_stray(paths, time, net, lasts)
        if length == 1:
            usual = _lower_quartile(stray)
        far = np.hypot(net[..., 0], net[..., 1])
        carried = NOTICED + ACCELERATION / 8 * lasts**2
        excess = stray - np.maximum(np.maximum(carried[:, None], far), JITTERS * usual)
        excess[lasts > LONGEST_JUMP] = 0.0
        far_off = np.flatnonzero(reaching & (stray.max(axis=0) > NOTICED))
        if len(far_off):
            left, turned = _measure_return(
                paths.take(far_off, axis=1), time, net.take(far_off, axis=1), lasts
            )
            carried = NOTICED + RETURN_ACCELERATION / 16 * lasts**2
            most = np.maximum(
                np.maximum(carried[:, None], far[:, far_off]),
                np.maximum(turned, JITTERS * usual[far_off]),
            )
            returned = np.minimum(stray[:, far_off], left) - most
            returned[lasts > longest] = 0.0
            excess[:, far_off] = np.maximum(excess[:, far_off], returned)
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


def _measure_return(
    paths: FloatArray, time: FloatArray, net: FloatArray, lasts: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Compute how far the positions between two moments leave the way that leads on.

    Parameters
    ----------
    paths, time, net, lasts
        As for `_measure_least_stray`.

    Returns
    -------
    ``(F, K)`` each: the smallest distance of a position in between from the cubic curve that has
    the velocities before and after, and by how much these two differ, per frame.

    """
    firsts, length = len(lasts), len(paths) - len(lasts) - 1
    velocities = np.diff(paths, axis=0) / np.diff(time)[:, None, None]
    before = velocities[np.arange(firsts) - 1]
    after = velocities[np.minimum(np.arange(firsts) + length + 1, len(velocities) - 1)]
    before[0], after[-1] = after[0], before[-1]
    change = np.linalg.norm(after - before, axis=2) * (lasts / (length + 1))[:, None]
    spans = lasts[:, None, None]
    least = np.full(net.shape[:2], np.inf)
    for between in range(1, length + 1):
        share = ((time[between : between + firsts] - time[:firsts]) / lasts)[:, None, None]
        bend = (1 - share) * (spans * before - net) + share * (net - spans * after)
        way = paths[:firsts] + share * net + share * (1 - share) * bend
        np.minimum(
            least, np.linalg.norm(paths[between : between + firsts] - way, axis=2), out=least
        )
    return least, change


FASTEST = 12.0
"""Torso lengths a second that no hand of a diver reaches: 6 m/s, a hand that throws."""

LEAST_LEAP = 0.4
"""Torso lengths of the shortest leap; two positions of a noisy landmark are nearer."""

SURE_LEAP = 1.0
"""Torso lengths of a leap that needs no rest around it."""

ALONE = 3.0
"""How many times longer than the steps before and after it a shorter leap is: a quick hand
gathers speed, a keypoint does not."""

LONGEST_AWAY = 1.0
"""Most seconds between a leap away and the leap back."""

RETURNED = 1.0
"""Largest distance after the leap back from where the landmark was before, as a share of the
shorter leap; the hand moves on meanwhile."""

FASTEST_BODY = 6.0
"""Torso lengths a second that no diver's body reaches within the picture: 3 m/s."""

OTHER_SIZE = 1.35
"""Ratio of torso lengths from which a moment shows another body; a diver who leans towards the
camera or away from it changes by less."""


def find_leaps(trajectory: Trajectory, landmarks: Sequence[str], fastest: float = FASTEST) -> Mask:
    """Find the steps at which one of the landmarks leaps.

    Parameters
    ----------
    trajectory
        At the moments of its frames.
    landmarks
        Names; those that the trajectory lacks are ignored.
    fastest
        Torso lengths a second beyond which a step is a leap.

    Returns
    -------
    ``(T,)``: whether a landmark leaps between the moment before and this one; the first is False.

    """
    leaps = np.zeros(len(trajectory), dtype=bool)
    unit = measure_body_unit(trajectory)
    for name in landmarks:
        if name not in trajectory.landmarks:
            continue
        path = trajectory.select([name]).xy[:, 0] / unit
        seen = np.flatnonzero(np.isfinite(path).all(axis=1))
        lasts = np.diff(trajectory.time[seen])
        far = np.linalg.norm(np.diff(path[seen], axis=0), axis=1)
        framed = np.concatenate([[0.0], far, [0.0]])
        alone = (far > ALONE * np.maximum(framed[:-2], framed[2:])) | (far > SURE_LEAP)
        sudden = alone & (far > LEAST_LEAP) & (far > fastest * lasts) & (lasts <= MAX_GAP_SECONDS)
        leaps[seen[1:][sudden]] = True
    return leaps


def find_unsteady(
    trajectory: Trajectory,
    landmarks: Sequence[str],
    *,
    fastest: float = FASTEST,
    longest: float = LONGEST_AWAY,
) -> Mask:
    """Find the moments at which one of the landmarks is away, between a leap and the leap back.

    Parameters
    ----------
    trajectory, landmarks, fastest
        As for `find_leaps`.
    longest
        Most seconds between the two leaps.

    Returns
    -------
    ``(T,)``; after such a stretch the landmark is nearer to where it was before than meanwhile.

    """
    away = np.zeros(len(trajectory), dtype=bool)
    for name in landmarks:
        leaps = np.flatnonzero(find_leaps(trajectory, [name], fastest)).tolist()
        if len(leaps) < 2:
            continue
        path = fill_all_gaps(trajectory.select([name]).xy, trajectory.time)[:, 0]
        pairs = sorted(combinations(leaps, 2), key=lambda pair: pair[1] - pair[0])
        for first, last in pairs:
            if trajectory.time[last] - trajectory.time[first] > longest or away[first:last].any():
                continue
            out, back = (np.linalg.norm(path[at] - path[at - 1]) for at in (first, last))
            if np.linalg.norm(path[last] - path[first - 1]) < RETURNED * min(out, back):
                away[first:last] = True
    return away


def find_other_body(trajectory: Trajectory) -> Mask:
    """Find the moments that show another body: the torso leaps away, or has another size.

    Returns
    -------
    ``(T,)``; nothing without a torso.

    """
    other = np.zeros(len(trajectory), dtype=bool)
    if trajectory.unit != "torso_length":
        return other
    half = float(trajectory.time[-1] - trajectory.time[0]) / 2
    other |= find_unsteady(trajectory, [TORSO], fastest=FASTEST_BODY, longest=half)
    if {*SHOULDERS, *HIPS} <= set(trajectory.landmarks):
        shoulders, hips = (trajectory.select(pair).xy.mean(axis=1) for pair in (SHOULDERS, HIPS))
        size = np.linalg.norm(shoulders - hips, axis=1)
        usual = np.nanmedian(size) if np.isfinite(size).any() else 1.0
        ratio = np.nan_to_num(size / usual, nan=1.0)
        other |= (ratio > OTHER_SIZE) | (ratio < 1 / OTHER_SIZE)
    return other
