"""Gaps: interpolates landmarks over the moments at which they are not seen."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]

MAX_GAP_SECONDS = 0.5
"""Longest gap that is bridged by a straight line, seconds.

Reaching movements last 0.5 s and more (Flash and Hogan 1985): a longer line could replace a whole
stroke, and an invented stroke is worse than a gap.
"""


def bridge_short_gaps(xy: FloatArray, time: FloatArray, max_gap: float) -> FloatArray:
    """Bridge gaps of at most `max_gap` seconds by straight lines; longer ones stay NaN.

    A gap lasts from the last moment a landmark is seen to the next one. Before the first and after
    the last of them there is nothing to bridge to.

    Parameters
    ----------
    xy
        ``(T, K, 2)``; NaN: not seen.
    time
        ``(T,)`` seconds, strictly increasing.

    """
    xy = xy.copy()
    seen = np.asarray(np.isfinite(xy).all(axis=2))
    for index in np.flatnonzero(~seen.all(axis=0)):
        path, known = xy[:, index], np.flatnonzero(seen[:, index])
        for gap in np.flatnonzero(np.diff(known) > 1):
            before, after = known[gap], known[gap + 1]
            span = time[after] - time[before]
            if span <= max_gap:
                inside = slice(before + 1, after)
                share = (time[inside] - time[before]) / span
                path[inside] = path[before] + share[:, None] * (path[after] - path[before])
    return xy


def fill_all_gaps(
    points: FloatArray, time: FloatArray, moments: FloatArray | None = None
) -> FloatArray:
    """Interpolate linearly in time, however long the gap; beyond the ends the nearest value holds.

    Parameters
    ----------
    points
        ``(T, K, D)``; a point is known where all its coordinates are finite.
    time
        ``(T,)`` seconds, strictly increasing.
    moments
        ``(N,)`` seconds at which the result is wanted; by default `time`.

    Returns
    -------
    points
        ``(N, K, D)``; NaN for a landmark that is never known.

    """
    at = time if moments is None else moments
    finite = np.isfinite(points)
    if moments is None and finite.all():
        return points
    known = np.asarray(finite.all(axis=2))
    filled = np.full((len(at), *points.shape[1:]), np.nan)
    for index in np.flatnonzero(known.any(axis=0)):
        seen = known[:, index]
        for axis in range(points.shape[2]):
            filled[:, index, axis] = np.interp(at, time[seen], points[seen, index, axis])
    return filled
