"""The trajectory image: a gesture's salient paths as white strokes on black, 224 x 224."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
import numpy.typing as npt

from app.recognition.features.contour import BinaryImage, Contour
from app.recognition.features.moments import StrokeMoments
from app.recognition.poses.sequence import FloatArray
from app.recognition.poses.trajectory import Trajectory

SIZE = 224
"""Width and height in pixels: the published implementation's, so that its files can be read."""

MARGIN = 16
"""Border in pixels around the paths: room for half a stroke, and for people to see a frame."""

STROKE_WIDTH = 9
"""Pixels. A twentieth of the drawing, the wobble of a hand in free air: two drawings of one figure
then overlap, and moments of area vary less. Wider strokes would run together in small loops."""

SIMPLIFICATION = 4.0
"""Tolerance of Ramer-Douglas-Peucker in pixels: just below half a stroke, so that no corner that
can be seen is lost, and jitter within the stroke is."""

MIN_EXTENT = 0.1
"""Least extent, in the trajectory's unit, that is drawn.

The drawing fills its frame, so anything smaller, 5 cm of a diver's sway, would be blown up to
look like a gesture.
"""

_SUBPIXEL_BITS = 4


@dataclass(frozen=True, eq=False)
class Drawing:
    """What a gesture looks like: the paths of its salient keypoints, and their image.

    Attributes
    ----------
    image
        The ``(224, 224)`` trajectory image; all zero when nothing moved.
    trajectory
        The salient keypoints' trajectory, or None for a gesture of which only the image is
        known (imported from the published implementation's files).

    """

    image: BinaryImage
    trajectory: Trajectory | None = None

    @cached_property
    def strokes(self) -> BinaryImage:
        """The part of the image that has strokes, ``(0, 0)`` where none has."""
        left, top, width, height = cv2.boundingRect(self.image)
        return self.image[top : top + height, left : left + width]

    @cached_property
    def contour(self) -> Contour:
        """The outer contours of the strokes, followed once for all voters that measure them."""
        return Contour.of(self.strokes)

    @cached_property
    def moments(self) -> StrokeMoments:
        """The moments of the strokes, measured once for all voters that are made of them."""
        return StrokeMoments.of(self.strokes)

    @property
    def empty(self) -> bool:
        """Tell whether there is no stroke in the image."""
        return self.strokes.size == 0


def draw(trajectory: Trajectory, simplification: float = SIMPLIFICATION) -> Drawing:
    """Draw the paths of a trajectory's landmarks into one image.

    The one way an image comes about, for reference and query alike: all landmarks share one
    frame, which is scaled to fill the image with its aspect kept; each unbroken stretch of a
    path is simplified by Ramer-Douglas-Peucker (Ramer 1972, Douglas and Peucker 1973) and drawn
    as one stroke.

    Parameters
    ----------
    trajectory
        Of the salient keypoints only.
    simplification
        Tolerance of Ramer-Douglas-Peucker in pixels.

    Returns
    -------
    The drawing; its image is empty where nothing is seen or the whole extent of the paths is
    below `MIN_EXTENT`.

    """
    image: BinaryImage = np.zeros((SIZE, SIZE), dtype=np.uint8)
    finite = np.isfinite(trajectory.xy)
    whole = bool(finite.all())
    known = np.asarray(finite.all(axis=2))
    seen = trajectory.xy.reshape(-1, 2) if whole else trajectory.xy[known]
    if not len(seen):
        return Drawing(image, trajectory)
    low, high = np.minimum.reduce(seen), np.maximum.reduce(seen)
    extent = float((high - low).max())
    if extent < MIN_EXTENT:
        return Drawing(image, trajectory)
    scale = (SIZE - 1 - 2 * MARGIN) / extent
    pixels = (trajectory.xy - (low + high) / 2) * scale + (SIZE - 1) / 2
    for index in range(len(trajectory.landmarks)):
        path = pixels[:, index]
        for stroke in [path] if whole else _strokes(path, known[:, index]):
            _draw_stroke(image, simplify(stroke, simplification))
    return Drawing(image, trajectory)


def _strokes(path: FloatArray, known: npt.NDArray[np.bool_]) -> list[FloatArray]:
    """Split ``(T, 2)`` where it is not known, ``(T,)``, into unbroken stretches."""
    ends = np.flatnonzero(np.diff(known, prepend=False, append=False))
    return [path[start:end] for start, end in ends.reshape(-1, 2)]


def _draw_stroke(image: BinaryImage, corners: FloatArray) -> None:
    grid = np.rint(corners * 2**_SUBPIXEL_BITS).astype(np.int32)[:, None]
    cv2.polylines(
        image, [grid], isClosed=False, color=255, thickness=STROKE_WIDTH, shift=_SUBPIXEL_BITS
    )


def simplify(path: FloatArray, tolerance: float) -> FloatArray:
    """Keep the corners of a path (Ramer 1972, Douglas and Peucker 1973).

    OpenCV's `approxPolyDP` is not used: of an open path that ends near where it began, it loses
    the last side.

    Parameters
    ----------
    path
        ``(T, 2)`` without NaN.
    tolerance
        Largest distance of a point left out from the line that replaces it, in the path's unit.

    Returns
    -------
    ``(C, 2)``: the first point, the corners in order, the last point.

    """
    kept = [0, len(path) - 1]
    open_stretches = [(0, len(path) - 1)]
    # Most stretches have a dozen points, for which plain numbers are faster than arrays.
    points = path.tolist()
    while open_stretches:
        first, last = open_stretches.pop()
        corner, away = _farthest_from_line(points, first, last)
        if away > tolerance:
            kept.append(corner)
            open_stretches += [(first, corner), (corner, last)]
    return path[sorted({*kept})]


def _farthest_from_line(points: list[list[float]], first: int, last: int) -> tuple[int, float]:
    """Return which point between two lies farthest from the segment that joins them, and how far.

    Of equally far ones the first; where there is none between, `first` and 0.
    """
    (start_x, start_y), (end_x, end_y) = points[first], points[last]
    along_x, along_y = end_x - start_x, end_y - start_y
    # What is the same for all points is taken out of the loop, where most of the time goes: their
    # products with the segment are not counted from its start, and all squares have this factor.
    length = along_x * along_x + along_y * along_y or 1.0
    passed_start = start_x * along_x + start_y * along_y
    passed_end = end_x * along_x + end_y * along_y
    beside_start = start_x * along_y - start_y * along_x
    farthest, largest, index = first, 0.0, first
    for x, y in points[first + 1 : last]:
        index += 1
        passed = x * along_x + y * along_y
        if passed_start < passed < passed_end:
            area = x * along_y - y * along_x - beside_start
            square = area * area
        else:
            # Before the start the segment's nearest place is its start, beyond the end its end.
            if passed <= passed_start:
                x -= start_x
                y -= start_y
            else:
                x -= end_x
                y -= end_y
            square = (x * x + y * y) * length
        if square > largest:
            farthest, largest = index, square
    return farthest, math.sqrt(largest / length)
