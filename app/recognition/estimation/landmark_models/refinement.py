"""Landmark refinement: corrects landmarks by the pose model's heat maps."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from app.recognition.poses.sequence import FloatArray

REACH: Final = 3
"""Heat-map cells used on each side of a landmark: the 7 x 7 window of MediaPipe Tasks."""

LEAST_PEAK: Final = 0.5
"""Least highest cell of the window; below it the landmark is not changed."""

_OFFSETS: Final = np.arange(-REACH, REACH + 1)


def sigmoid(values: npt.NDArray[np.floating]) -> FloatArray:
    """Return the logistic function of `values`; 80 is where it reaches 0 or 1 in float32."""
    clipped = np.clip(values, -80, 80).astype(np.float64)
    return np.asarray(1 / (1 + np.exp(-clipped)))


def refine(xy: FloatArray, heatmap: npt.NDArray[np.float32]) -> FloatArray:
    """Move each landmark to the centre of gravity of its heat map around it.

    Regressed coordinates are steady but coarse, heat maps exact but local (Bazarevsky et al.
    2020, BlazePose, Sec. 2.3): the coordinates select the window of the heat map.

    Parameters
    ----------
    xy
        ``(N, 2)`` landmarks in [0, 1] of the model's input, x right, y down. Those outside
        are left as they are.
    heatmap
        ``(rows, columns, N)`` logits, one channel per landmark.

    Returns
    -------
    ``(N, 2)`` refined landmarks, a new array.

    """
    rows, columns, count = heatmap.shape
    size = np.array([columns, rows])
    centre = (xy * size).astype(np.intp)
    inside = ((centre >= 0) & (centre < size)).all(axis=1)
    column = centre[:, 0, None] + _OFFSETS
    row = centre[:, 1, None] + _OFFSETS
    in_map = (
        (((row >= 0) & (row < rows))[:, :, None])
        & (((column >= 0) & (column < columns))[:, None, :])
    )
    cells = heatmap[
        row.clip(0, rows - 1)[:, :, None],
        column.clip(0, columns - 1)[:, None, :],
        np.arange(count)[:, None, None],
    ]
    weight = np.where(in_map, sigmoid(cells), 0.0)
    total = weight.sum(axis=(1, 2))
    trusted = inside & (weight.max(axis=(1, 2)) >= LEAST_PEAK)
    by_column = (weight.sum(axis=1) * column).sum(axis=1)
    by_row = (weight.sum(axis=2) * row).sum(axis=1)
    refined = xy.copy()
    moments = np.stack([by_column, by_row], axis=1)[trusted]
    refined[trusted] = moments / total[trusted, None] / size
    return refined
